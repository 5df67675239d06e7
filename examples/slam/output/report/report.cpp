// SPDX-License-Identifier: BSD-3-Clause
#include "slam/output/report/report.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>

#include "slam/output/append_file.hpp"
#include "slam/output/report/assets.hpp"
#include "slam/output/report/chart_data.hpp"
#include "slam/output/report/html.hpp"
#include "slam/output/report/thin_frames.hpp"
#include "support/stage_times.hpp"

namespace hmcdyn::slam {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kPictureBytes = 8'000'000;
constexpr std::size_t kLoopRows = 500;

void checkStages(const ReportInput& input) {
  for (std::size_t i = 0; i < input.frames.size(); ++i) {
    if (input.frames[i].stage_ms.size() != input.stages.size()) {
      throw std::invalid_argument(fmt::format("report: frame {} has {} stage times; expected {}", i,
                                              input.frames[i].stage_ms.size(),
                                              input.stages.size()));
    }
  }
}

/// The JSON value at a path such as "/evaluation/ate_m/rmse"; NaN where there is no number.
double numberAt(const Json& json, const char* path) {
  const Json::json_pointer pointer(path);
  const Json value = json.is_object() && json.contains(pointer) ? json.at(pointer) : Json();
  return value.is_number() ? value.get<double>() : std::numeric_limits<double>::quiet_NaN();
}

Json objectAt(const Json& json, const char* key) {
  return json.is_object() && json.contains(key) ? json.at(key) : Json();
}

std::string figure(const std::string& name, double value, int decimals, const std::string& unit) {
  const std::string text = std::isfinite(value)
                               ? fmt::format("{:.{}f} <small>{}</small>", value, decimals, unit)
                               : "<small>unknown</small>";
  return fmt::format("<div class=\"card\"><dt>{}</dt><dd>{}</dd></div>\n", name, text);
}

/// Root mean square of the frames' errors (m); NaN where none is known.
double rmsError(const std::vector<ReportFrame>& frames) {
  double sum = 0.0;
  double count = 0.0;
  for (const ReportFrame& frame : frames) {
    if (std::isfinite(frame.error)) {
      sum += frame.error * frame.error;
      count += 1.0;
    }
  }
  return std::sqrt(sum / count);
}

/// The finite ones of a stage's times (ms).
std::vector<double> timesOf(const ReportInput& input, std::size_t stage) {
  std::vector<double> times;
  for (const ReportFrame& frame : input.frames) {
    if (std::isfinite(frame.stage_ms[stage])) {
      times.push_back(frame.stage_ms[stage]);
    }
  }
  return times;
}

/// Each frame's sum over its stages (ms), of those that ran at least one.
std::vector<double> frameTimes(const ReportInput& input) {
  std::vector<double> times;
  for (const ReportFrame& frame : input.frames) {
    double sum = 0.0;
    bool ran = false;
    for (const double ms : frame.stage_ms) {
      ran = ran || std::isfinite(ms);
      sum += std::isfinite(ms) ? ms : 0.0;
    }
    if (ran) {
      times.push_back(sum);
    }
  }
  return times;
}

/// Frames of the run.
std::size_t framesInAll(const ReportInput& input) {
  return std::max(input.frames_in_all, input.frames.size());
}

std::string headline(const ReportInput& input) {
  std::size_t tracked = 0;
  std::size_t dynamic = 0;
  std::size_t points = 0;
  for (const ReportFrame& frame : input.frames) {
    tracked += frame.failure.empty() ? 1 : 0;
    dynamic += frame.dynamic_points;
    points +=
        frame.static_points + frame.suspect_points + frame.dynamic_points + frame.unmatched_points;
  }
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double reported = numberAt(input.summary, "/evaluation/ate_m/rmse");
  const double ate = std::isfinite(reported) ? reported : rmsError(input.frames);
  const std::vector<double> times = frameTimes(input);
  std::string html = "<dl class=\"figures\">\n";
  html += figure("Absolute trajectory error (RMSE)", ate, 4, "m");
  html += figure("Relative error, translation",
                 numberAt(input.summary, "/evaluation/rpe_translation_m_per_s/rmse"), 4, "m/s");
  html += figure("Relative error, rotation",
                 numberAt(input.summary, "/evaluation/rpe_rotation_deg_per_s/rmse"), 3, "°/s");
  html += figure("Frames tracked",
                 framesInAll(input) == input.frames.size()
                     ? static_cast<double>(tracked)
                     : numberAt(input.summary, "/counts/frames_tracked"),
                 0, fmt::format("of {}", framesInAll(input)));
  html += figure("Time a frame (mean)", times.empty() ? nan : support::timeStatistics(times).mean,
                 1, "ms");
  html +=
      figure("Key points on moving things",
             points == 0 ? nan : 100.0 * static_cast<double>(dynamic) / static_cast<double>(points),
             1, "%");
  return html + "</dl>\n";
}

std::string warningList(const ReportInput& input) {
  std::string items;
  const Json warnings = objectAt(input.summary, "warnings");
  for (const Json& warning : warnings.is_array() ? warnings : Json::array()) {
    const std::string text = warning.is_string()
                                 ? warning.get<std::string>()
                                 : warning.dump(-1, ' ', false, Json::error_handler_t::replace);
    items += "<li>" + escapeHtml(text) + "</li>\n";
  }
  return items.empty() ? "" : "<ul class=\"warnings\">\n" + items + "</ul>\n";
}

std::string chart(const char* id, const char* title) {
  return fmt::format("<div class=\"chart card\" id=\"{}\"><h3>{}</h3></div>\n", id, title);
}

/// What the charts are drawn from: of a long run not all frames.
ReportInput shownOf(const ReportInput& input) {
  ReportInput shown;
  shown.stages = input.stages;
  shown.loops = input.loops;
  for (const std::size_t i : framesToShow(input)) {
    shown.frames.push_back(input.frames[i]);
  }
  return shown;
}

/// What a run that is too long to be remembered frame by frame leaves out.
std::string forgettingNote(const ReportInput& input) {
  return framesInAll(input) == input.frames.size()
             ? ""
             : fmt::format(
                   "<p class=\"note\">Of {} frames this page remembers {}, evenly over the run but "
                   "for lost ones and key frames, which stay longer: times and shares are of "
                   "these.</p>\n",
                   framesInAll(input), input.frames.size());
}

std::string thinningNote(std::size_t shown, std::size_t all) {
  return shown == all
             ? ""
             : fmt::format(
                   "<p class=\"note\">The charts show {} of {} frames: of each stretch of the run "
                   "the first one and those with the largest error, time, dynamic points and "
                   "boxes, "
                   "the fewest static points, and the first one lost. Figures and tables are of "
                   "all frames; every frame is in trajectory.txt and timings.csv.</p>\n",
                   shown, all);
}

std::string trajectorySection(const Json& data) {
  const bool has_error = !data.at("error").is_null();
  std::string html = "<h2>Trajectory</h2>\n<div class=\"scale\">";
  html +=
      has_error
          ? fmt::format("0 <i></i> {:.1f} mm error", 1e3 * data.at("max_error").get<double>())
          : std::string("No ground truth: the estimate alone, in the world of its first frame.");
  html += data.at("truth").is_null() ? "" : "&ensp;<b></b> ground truth";
  html += data.at("loops").empty() ? "" : "&ensp;<b class=\"loop\"></b> closed loop";
  return html + "</div>\n<div class=\"views\">\n" + chart("chart-top", "From above") +
         chart("chart-front", "From the front") + chart("chart-side", "From the side") + "</div>\n";
}

std::string timeSection(const Json& data) {
  std::string html = "<div class=\"bar\">Time axis, all charts:";
  for (const auto& [action, text] :
       {std::pair{"in", "+"}, {"out", "−"}, {"left", "◀"}, {"right", "▶"}, {"all", "whole run"}}) {
    html += fmt::format(R"(<button type="button" data-zoom="{}">{}</button>)", action, text);
  }
  html +=
      "<span>Drag in a chart to zoom, double-click to go back; Ctrl or Shift and the wheel works, "
      "too."
      "</span></div>\n";
  if (!data.at("error").is_null()) {
    html +=
        "<h2>Error over time</h2>\n<p class=\"note\">Distance to the ground truth after alignment; "
        "frames without a pose shaded.</p>\n" +
        chart("chart-error", "Absolute error");
  }
  return html;
}

std::string stageTable(const ReportInput& input) {
  std::vector<std::vector<std::string>> rows;
  const auto add = [&](const std::string& name, const std::vector<double>& times) {
    const support::TimeStatistics s = support::timeStatistics(times);
    rows.push_back({name, fmt::format("{}", times.size()), fmt::format("{:.2f}", s.mean),
                    fmt::format("{:.2f}", s.median), fmt::format("{:.2f}", s.p95)});
  };
  for (std::size_t i = 0; i < input.stages.size(); ++i) {
    add(input.stages[i], timesOf(input, i));
  }
  add("all stages", frameTimes(input));
  return "<div class=\"card\">" +
         htmlTable({"stage", "frames", "mean (ms)", "median (ms)", "p95 (ms)"}, rows) + "</div>\n";
}

std::string loopSection(const std::vector<LoopRow>& loops) {
  if (loops.empty()) {
    return "";
  }
  std::vector<std::vector<std::string>> rows;
  for (const LoopRow& loop : loops) {
    if (rows.size() == kLoopRows) {
      break;
    }
    rows.push_back({loop.refusal.empty() ? "accepted" : loop.refusal,
                    fmt::format("{:.3f}", loop.timestamp),
                    fmt::format("{:.3f}", loop.matched_timestamp),
                    std::isfinite(loop.score) ? fmt::format("{:.3g}", loop.score) : "–",
                    fmt::format("{}", loop.inliers)});
  }
  std::string html = "<h2>Loops</h2>\n";
  if (loops.size() > kLoopRows) {
    html += fmt::format(
        "<p class=\"note\">The first {} of {} candidates; the others are in loops.csv.</p>\n",
        kLoopRows, loops.size());
  }
  return html + "<div class=\"card\">" +
         htmlTable({"verdict", "key frame (s)", "matched with (s)", "score", "inliers"}, rows) +
         "</div>\n";
}

std::string pictureSection(const std::vector<ReportPicture>& pictures) {
  std::string html;
  std::size_t bytes = 0;
  std::size_t left_out = 0;
  for (const ReportPicture& picture : pictures) {
    if (bytes + picture.jpeg.size() > kPictureBytes) {
      ++left_out;
      continue;
    }
    bytes += picture.jpeg.size();
    const std::string caption = escapeHtml(picture.caption);
    html += fmt::format(R"(<figure><img loading="lazy" alt="{0}" src="data:image/jpeg;base64,{1}">)"
                        "<figcaption>{0}</figcaption></figure>\n",
                        caption, base64(picture.jpeg));
  }
  if (pictures.empty()) {
    return "";
  }
  const std::string note =
      left_out == 0 ? "" : fmt::format(" {} more would make the page too large.", left_out);
  return "<h2>Frames</h2>\n<p class=\"note\">Key points: static green, suspect yellow, dynamic "
         "red, "
         "unmatched blue-grey; boxes red where they move." +
         note + "</p>\n<div class=\"pictures\">\n" + html + "</div>\n";
}

std::string tableSection(const char* title, const Json& json, bool open) {
  const std::string table = jsonTable(json);
  return table.empty()
             ? ""
             : fmt::format("<h2>{}</h2>\n<details{}><summary>{}</summary><div class=\"card\">\n",
                           title, open ? " open" : "", open ? "hide" : "show") +
                   table + "</div></details>\n";
}

std::string script(std::string_view code) {
  return "<script>\n" + std::string(code) + "\n</script>\n";
}

std::string head(const std::string& title) {
  // The policy makes sure that nothing is fetched; the first script notes what goes wrong later.
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
         "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src "
         "data:; "
         "style-src 'unsafe-inline'; script-src 'unsafe-inline'\">\n<title>" +
         escapeHtml(title) + "</title>\n<style>\n" + std::string(assets::uplotCss()) + "\n" +
         std::string(assets::pageCss()) + "</style>\n" + script(R"(window.hmcdynErrors = [];
addEventListener("error", (e) => hmcdynErrors.push(String(e.message)));
addEventListener("unhandledrejection", (e) => hmcdynErrors.push(String(e.reason)));
for (const say of ["error", "warn"]) {
  const original = console[say];
  console[say] = (...what) => { hmcdynErrors.push(what.join(" ")); original.apply(console, what); };
})") + "</head>\n";
}

}  // namespace

std::vector<ReportFrame> withGroundTruth(std::vector<ReportFrame> frames,
                                         const evaluate::AteResult& result) {
  constexpr double kSameStamp = 1e-5;  // s
  for (ReportFrame& frame : frames) {
    frame.position = result.alignment * frame.position;
    const auto pair = std::lower_bound(result.timestamps.begin(), result.timestamps.end(),
                                       frame.timestamp - kSameStamp);
    if (pair == result.timestamps.end() || *pair > frame.timestamp + kSameStamp ||
        !frame.position.allFinite()) {
      continue;
    }
    const auto i = static_cast<std::size_t>(pair - result.timestamps.begin());
    frame.truth = result.groundtruth[i];
    frame.error = result.errors[i];
  }
  return frames;
}

std::string renderReport(const ReportInput& input) {
  checkStages(input);
  const ReportInput shown = shownOf(input);
  const Json data = chartData(shown);
  std::string html = head(input.title);
  html += "<body>\n<header><h1>" + escapeHtml(input.title) + "</h1>\n";
  html += fmt::format("<p class=\"note\">hmcdyn_slam, {} frames</p></header>\n<main>\n",
                      framesInAll(input));
  html += headline(input) + warningList(input) + forgettingNote(input) +
          thinningNote(shown.frames.size(), input.frames.size()) + trajectorySection(data) +
          timeSection(data);
  html +=
      "<h2>Time a frame</h2>\n<p class=\"note\">Wall time by stage, one on top of the "
      "other.</p>\n" +
      chart("chart-stages", "Stages") + stageTable(input);
  html +=
      "<h2>Key points and boxes</h2>\n<p class=\"note\">What the filter made of each frame's key "
      "points "
      "and of the detector's boxes.</p>\n" +
      chart("chart-labels", "Key points by verdict") + chart("chart-boxes", "Boxes");
  html +=
      "<h2>Frame by frame</h2>\n<p class=\"note\">The motion model the filter judged by, key "
      "frames, and "
      "why frames were lost.</p>\n" +
      chart("chart-states", "Verdicts");
  html += pictureSection(input.pictures) + loopSection(input.loops);
  html += tableSection("Counts", objectAt(input.summary, "counts"), false) +
          tableSection("Options", objectAt(input.summary, "options"), false) +
          tableSection("Versions", objectAt(input.summary, "versions"), true);
  html += "</main>\n<footer><details><summary>Charts: uPlot 1.6.32, MIT licence</summary><p>" +
          escapeHtml(std::string(assets::uplotLicence())) + "</p></details></footer>\n";
  html += "<script id=\"status\" type=\"application/json\"></script>\n";
  html += R"(<script id="data" type="application/json">)" + scriptJson(data) + "</script>\n";
  html += script(assets::uplotJs()) + script(assets::pageJs()) + "</body>\n</html>\n";
  return html;
}

void writeReport(const std::filesystem::path& file, const ReportInput& input) {
  replaceFile(file, renderReport(input));
}

}  // namespace hmcdyn::slam
