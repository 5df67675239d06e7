// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "file_content.hpp"
#include "slam/input/dataset/temporary_folder.hpp"
#include "slam/output/report/report.hpp"
#include "slam/output/report/sample_run.hpp"

namespace hmcdyn::slam {
namespace {

using hmcdyn::test::contentOf;
using test::sampleRun;

/// The browser's name; empty where none is installed.
std::string browser() {
  for (const char* name : {"chromium", "chromium-browser", "google-chrome"}) {
    if (std::system((std::string("command -v ") + name + " >/dev/null 2>&1").c_str()) == 0) {
      return name;
    }
  }
  return {};
}

/// What a page says of itself after it was drawn.
struct DrawnPage {
  nlohmann::json status;  ///< {"charts": [{id, series, points, ink}], "errors": [...]}.
  std::string log;        ///< The browser's lines about scripts.
  std::size_t bytes = 0;  ///< Of the page.
};

class ReportPage : public testing::Test {
 protected:
  void SetUp() override {
    if (browser().empty()) {
      GTEST_SKIP() << "no chromium, chromium-browser or google-chrome is installed, so the page is "
                      "not opened (scripts/install_dependencies.sh --ci installs it)";
    }
  }

  DrawnPage draw(const ReportInput& input, const std::string& window = "1280,1000") const {
    const std::filesystem::path page = folder_.path() / "report.html";
    const std::filesystem::path dom = folder_.path() / "dom.html";
    const std::filesystem::path log = folder_.path() / "log.txt";
    writeReport(page, input);
    // The clock of the page is virtual: it is read when all timers of the first 5 s have run.
    const std::string command =
        "timeout 120 " + browser() +
        " --headless --no-sandbox --disable-gpu --disable-quic --no-first-run"
        " --disable-background-networking --disable-component-update --disable-sync"
        " --disable-dev-shm-usage --enable-logging=stderr --virtual-time-budget=5000"
        " --user-data-dir='" +
        (folder_.path() / "profile").string() + "' --window-size=" + window +
        " --dump-dom 'file://" + page.string() + "#check' >'" + dom.string() + "' 2>'" +
        log.string() + "'";
    EXPECT_EQ(std::system(command.c_str()), 0) << contentOf(log);
    DrawnPage drawn;
    drawn.bytes = std::filesystem::file_size(page);
    const std::string text = contentOf(dom);
    const std::string mark = "<script id=\"status\" type=\"application/json\">";
    const std::size_t start = text.find(mark);
    if (start == std::string::npos) {
      ADD_FAILURE() << "the page has no status; the browser says:\n" << contentOf(log);
      return drawn;
    }
    const std::size_t from = start + mark.size();
    const std::string status = text.substr(from, text.find("</script>", from) - from);
    drawn.status = nlohmann::json::parse(status, nullptr, false);
    std::ifstream lines(log);
    for (std::string line; std::getline(lines, line);) {
      if (line.find("CONSOLE") != std::string::npos) {
        drawn.log += line + "\n";
      }
    }
    return drawn;
  }

  /// No script error, and the charts with these names all hold points and ink, and no others do.
  static void expectCharts(const DrawnPage& drawn, std::vector<std::string> expected) {
    ASSERT_TRUE(drawn.status.is_object()) << "the page's script did not reach its end";
    EXPECT_EQ(drawn.status["errors"], nlohmann::json::array());
    EXPECT_EQ(drawn.log, "");
    std::vector<std::string> names;
    for (const nlohmann::json& chart : drawn.status["charts"]) {
      names.push_back(chart["id"]);
      EXPECT_GT(chart["points"].get<int>(), 0) << names.back();
      EXPECT_GT(chart["ink"].get<int>(), 10) << names.back() << " is blank";
    }
    std::sort(names.begin(), names.end());
    std::sort(expected.begin(), expected.end());
    EXPECT_EQ(names, expected);
  }

  const std::vector<std::string> all_{"chart-top",   "chart-front",  "chart-side",
                                      "chart-error", "chart-stages", "chart-labels",
                                      "chart-boxes", "chart-states"};
  const std::vector<std::string> without_error_{"chart-top",    "chart-front",  "chart-side",
                                                "chart-stages", "chart-labels", "chart-boxes",
                                                "chart-states"};

 private:
  test::TemporaryFolder folder_;
};

TEST_F(ReportPage, DrawsEveryChartOfARun) {
  ReportInput input = sampleRun(300);
  input.loops = {{1700000005.0, 1700000001.0, 0.5, 60, ""},
                 {1700000006.0, 1700000002.0, 0.1, 3, "few"}};
  const DrawnPage drawn = draw(input);
  expectCharts(drawn, all_);
  // The zoom button halves the time axis of all five charts over time, the other shows all again.
  ASSERT_EQ(drawn.status["zoomed"].size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_NEAR(drawn.status["zoomed"][i].get<double>(), 0.5, 1e-9);
    EXPECT_NEAR(drawn.status["restored"][i].get<double>(), 1.0, 1e-9);
  }
  for (const nlohmann::json& chart : drawn.status["charts"]) {
    if (chart["id"] == "chart-error") {
      EXPECT_EQ(chart["points"], 288) << "300 frames, 12 lost";
    } else if (chart["id"] == "chart-stages") {
      EXPECT_EQ(chart["series"], 5);
      EXPECT_EQ(chart["points"], 1500);
    }
  }
}

TEST_F(ReportPage, DrawsOnAPhone) { expectCharts(draw(sampleRun(60), "390,800"), all_); }

TEST_F(ReportPage, DrawsARunWithoutGroundTruth) {
  ReportInput input = sampleRun(60);
  for (ReportFrame& frame : input.frames) {
    frame.truth = unknownPosition();
    frame.error = std::numeric_limits<double>::quiet_NaN();
  }
  expectCharts(draw(input), without_error_);
}

TEST_F(ReportPage, DrawsOneFrame) { expectCharts(draw(sampleRun(1)), all_); }

TEST_F(ReportPage, OpensWithoutAnyFrame) { expectCharts(draw({}), {}); }

TEST_F(ReportPage, LeavesOutWhatIsNotFinite) {
  ReportInput input = sampleRun(40);
  input.frames[3].position.x() = std::numeric_limits<double>::infinity();
  input.frames[5].error = std::numeric_limits<double>::infinity();
  input.frames[7].timestamp = std::numeric_limits<double>::quiet_NaN();
  input.frames[9].stage_ms.assign(5, std::numeric_limits<double>::quiet_NaN());
  expectCharts(draw(input), all_);
}

TEST_F(ReportPage, TakesStampsThatGoBack) {
  ReportInput input = sampleRun(40);
  std::swap(input.frames[10].timestamp, input.frames[20].timestamp);
  expectCharts(draw(input), all_);
}

TEST_F(ReportPage, TakesTextsThatLookLikeMarkup) {
  const std::string evil = "</script><script>throw 1</script>\"'<b>&\xe9\xff";
  ReportInput input = sampleRun(20);
  input.title = evil;
  input.stages[0] = evil;
  input.frames[4].failure = evil;
  input.frames[5].model = evil;
  input.summary = {{"warnings", {evil}}, {"options", {{evil, evil}}}};
  input.pictures = {{evil, "no JPEG"}};
  input.loops = {{1.0, 0.0, 0.0, 0, evil}};
  expectCharts(draw(input), all_);
}

TEST_F(ReportPage, TwentyThousandFramesStayBelowFifteenMegabytes) {
  const DrawnPage drawn = draw(sampleRun(20000));
  expectCharts(drawn, all_);
  EXPECT_LT(drawn.bytes, 15'000'000U);
}

}  // namespace
}  // namespace hmcdyn::slam
