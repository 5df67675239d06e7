// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdio>

#include "integration/frame_filter.hpp"

extern const hmcdyn::integration::FrameFilterResult result;
