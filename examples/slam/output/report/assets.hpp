// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

/// The page's own files, put into the binary when it is built (EmbedFiles.cmake).
namespace hmcdyn::slam::assets {

std::string_view pageCss() noexcept;       ///< page/page.css
std::string_view pageJs() noexcept;        ///< page/page.js
std::string_view uplotCss() noexcept;      ///< third_party/uplot/uPlot.min.css
std::string_view uplotJs() noexcept;       ///< third_party/uplot/uPlot.iife.min.js
std::string_view uplotLicence() noexcept;  ///< third_party/uplot/LICENSE

}  // namespace hmcdyn::slam::assets
