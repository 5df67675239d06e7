// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <exception>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>
#include <variant>

#include <opencv2/imgcodecs.hpp>

#include "evaluate/command_line.hpp"
#include "evaluate/plot.hpp"
#include "evaluate/report.hpp"
#include "evaluate/runs.hpp"

namespace {

using namespace hmcdyn::evaluate;

void writeText(const std::filesystem::path& file, const std::string& text) {
  std::ofstream stream(file);
  stream << text;
  stream.close();
  if (!stream) {
    throw std::runtime_error(file.string() + ": cannot be written");
  }
}

void writePicture(const std::filesystem::path& file, const cv::Mat& picture) {
  bool written = false;
  try {
    written = cv::imwrite(file.string(), picture);
  } catch (const cv::Exception&) {  // no encoder for the file's extension
  }
  if (!written) {
    throw std::runtime_error(file.string() + ": the picture cannot be written");
  }
}

void run(const Arguments& arguments) {
  const Evaluation evaluation = evaluateRuns(arguments, [](const std::string& note) {
    std::fprintf(stderr, "hmcdyn_evaluate: %s\n", note.c_str());
  });
  const std::string report =
      arguments.json ? toJson(arguments, evaluation.runs) : toTable(arguments, evaluation.runs);
  if (arguments.output.empty()) {
    std::cout << report << std::flush;
  } else {
    writeText(arguments.output, report);
  }
  if (!arguments.plot.empty()) {
    writePicture(arguments.plot, drawRuns(evaluation, arguments.offset));
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const auto parsed = parseCommandLine(argc, argv);
    if (const int* exit_code = std::get_if<int>(&parsed)) {
      return *exit_code;
    }
    run(std::get<Arguments>(parsed));
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "hmcdyn_evaluate: %s\n", error.what());
    return 1;
  }
}
