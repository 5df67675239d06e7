// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "evaluate/paper_results.hpp"
#include "evaluate/result_tables.hpp"
#include "evaluate/run_summary.hpp"
#include "support/command_line.hpp"

namespace {

namespace fs = std::filesystem;
using hmcdyn::evaluate::collectRuns;
using hmcdyn::evaluate::makeTables;
using hmcdyn::evaluate::readPaperResults;
using hmcdyn::evaluate::ResultTable;
using hmcdyn::evaluate::RunCollection;

struct Arguments {
  fs::path runs;
  fs::path paper;
  fs::path output;
  fs::path check;
  bool rendered = false;
};

void write(const fs::path& file, const std::string& text) {
  std::ofstream stream(file);
  stream << text;
  stream.close();
  if (!stream) {
    throw std::runtime_error(file.string() + ": cannot be written");
  }
}

void writeTables(const Arguments& arguments) {
  const RunCollection collection = collectRuns(arguments.runs);
  for (const std::string& run : collection.unfinished) {
    fmt::print(stderr, "hmcdyn_tables: left out: {}\n", run);
  }
  if (collection.runs.empty()) {
    throw std::runtime_error(arguments.runs.string() +
                             ": no finished run; expected SEQUENCE/VARIANT/RUN/summary.json");
  }
  fs::create_directories(arguments.output);
  std::string page = fmt::format("# Results of {} runs\n", collection.runs.size());
  page +=
      "\nMean over the runs, lowest and highest in brackets; - = not measured, or not in the "
      "paper.\n";
  if (!collection.unfinished.empty()) {
    page += fmt::format("\n**{} runs are not in these tables:** they failed or were stopped.\n",
                        collection.unfinished.size());
  }
  for (const ResultTable& table :
       makeTables(collection.runs, readPaperResults(arguments.paper), arguments.rendered)) {
    page += "\n" + toMarkdown(table);
    write(arguments.output / (table.name + ".csv"), toCsv(table));
  }
  write(arguments.output / "tables.md", page);
  fmt::print("{}", page);
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("Writes the tables of the HMC-SLAM paper from the summaries of runs of hmcdyn_slam.",
               "hmcdyn_tables");
  app.footer(
      "Runs lie in RUNS/SEQUENCE/VARIANT/RUN/summary.json; variants: hmc, rs, df, opw, none, "
      "chi2,\n"
      "two_threshold, depth_ransac. Writes tables.md, and a CSV file a table. "
      "scripts/reproduce.sh\n"
      "makes the runs.\n"
      "Exit code: 0 done, 1 a file is missing or malformed, 2 wrong usage.");
  CLI::Option* const check =
      app.add_option("--check", arguments.check,
                     "Only say by the exit code whether this summary.json is of a finished run");
  CLI::Option* const runs = app.add_option("--runs", arguments.runs, "Folder of the runs");
  CLI::Option* const paper =
      app.add_option("--paper", arguments.paper, "The paper's figures (scripts/paper_tables.csv)");
  CLI::Option* const output =
      app.add_option("--output", arguments.output, "Folder for the tables; made if missing");
  runs->needs(paper)->needs(output)->excludes(check);
  app.add_flag("--rendered", arguments.rendered,
               "Say that the sequences are rendered, not the paper's");
  const auto code = hmcdyn::support::parseCommandLine(app, argc, argv, [&] {
    if (check->count() + runs->count() == 0) {
      throw CLI::RequiredError("--runs or --check");
    }
  });
  if (code) {
    return *code;
  }
  try {
    if (check->count() > 0) {
      hmcdyn::evaluate::readRunSummary(arguments.check);
    } else {
      writeTables(arguments);
    }
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "hmcdyn_tables: %s\n", error.what());
    return 1;
  }
}
