// SPDX-License-Identifier: BSD-3-Clause
#include "slam/output/report/html.hpp"

#include <limits>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace hmcdyn::slam {
namespace {

TEST(EscapeHtml, MarkupBecomesText) {
  EXPECT_EQ(escapeHtml("a<b> & \"c\" 'd'"), "a&lt;b&gt; &amp; &quot;c&quot; &#39;d&#39;");
}

TEST(EscapeHtml, BytesThatAreNoUtf8AreReplaced) {
  EXPECT_EQ(escapeHtml("caf\xe9"), "caf\xef\xbf\xbd");
  EXPECT_EQ(escapeHtml("caf\xc3\xa9"), "caf\xc3\xa9");
}

TEST(EscapeHtml, ControlCharactersBecomeBlanks) {
  EXPECT_EQ(escapeHtml(std::string("a\0b\x1b\nc", 6)), "a b  c");
}

TEST(ScriptJson, NoTextCanEndTheScript) {
  const std::string text = scriptJson({{"k", "</script><!--\xe2\x80\xa8"}});
  EXPECT_EQ(text, R"({"k":"\u003c/script>\u003c!--\u2028"})");
  EXPECT_EQ(nlohmann::json::parse(text)["k"], "</script><!--\xe2\x80\xa8");
}

TEST(ScriptJson, WhatIsNotFiniteIsNull) {
  EXPECT_EQ(scriptJson({std::numeric_limits<double>::quiet_NaN(), 1.5}), "[null,1.5]");
}

TEST(Base64, GivesTheResultsOfRfc4648) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xff\xfe"), "//4=");
}

TEST(Tables, HoldEscapedCells) {
  EXPECT_EQ(htmlTable({"a", "b"}, {{"<x>", "1"}}),
            "<div class=\"scroll\"><table>\n<thead><tr><th>a</th><th class=\"n\">b</th></tr>\n"
            "</thead>\n<tbody>\n<tr><td>&lt;x&gt;</td><td class=\"n\">1</td></tr>\n"
            "</tbody></table></div>\n");
}

TEST(Tables, OfJsonNameTheLeaves) {
  const std::string table = jsonTable({{"flow", {{"window_px", 15}}}, {"camera", "tum3"}});
  EXPECT_NE(table.find("<tr><td>flow.window_px</td><td>15</td></tr>"), std::string::npos) << table;
  EXPECT_NE(table.find("<tr><td>camera</td><td>tum3</td></tr>"), std::string::npos) << table;
  EXPECT_EQ(jsonTable(nullptr), "");
  EXPECT_EQ(jsonTable(nlohmann::json::object()), "");
}

}  // namespace
}  // namespace hmcdyn::slam
