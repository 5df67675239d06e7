// SPDX-License-Identifier: BSD-3-Clause
// What a compiler must be told, and must not be told, for the headers to mean what they say. Where
// it is not so, the compiler stops here: a missing file is the one error after which it reads on no
// further, and hundreds of errors in templates would hide the sentence.
#pragma once

#if !defined(_MSVC_LANG) && __cplusplus < 201703L
#error "hmcdyn needs C++17: compile with -std=c++17 or newer (CMake: CMAKE_CXX_STANDARD 17)"
#include "hmcdyn stops here, for the reason above"
#endif

#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error \
    "hmcdyn cannot be compiled with -ffast-math, -Ofast or -ffinite-math-only: a distance, depth or belief of NaN means 'none' here, the compiler would take every comparison with it as it likes, and labels would change without a word; write -fno-fast-math after it, for this file at least"
#include "hmcdyn stops here, for the reason above"
#endif
