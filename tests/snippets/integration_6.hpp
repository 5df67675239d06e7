// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdio>

#include <hmcdyn/frame_filter.hpp>

extern const hmcdyn::FrameFilterResult result;
