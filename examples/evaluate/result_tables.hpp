// SPDX-License-Identifier: BSD-3-Clause
// The tables of the paper's experiments, from the runs' summaries.
#pragma once

#include <string>
#include <vector>

#include "evaluate/paper_results.hpp"
#include "evaluate/run_summary.hpp"

namespace hmcdyn::evaluate {

/// A table as text, ready to be written.
struct ResultTable {
  std::string name;   ///< Of its file: "table_1".
  std::string title;  ///< What it shows, in which unit.
  std::string note;   ///< How to read it; may be empty.
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;  ///< Each as long as the header.
};

/// Tables I to VI, and the improvement over no filter (eq. 12). Per sequence and system: the mean
/// over the runs, lowest and highest in brackets, and beside it the paper's figure where there is
/// one. What was not measured is "-", never 0.
///
/// Variants by name: hmc, rs, df, opw (Tables I, II); none stands beside the paper's ORB-SLAM3,
/// chi2 beside OVD-SLAM, two_threshold beside SG-SLAM, which are the rules alone in our system.
/// @param rendered whether the sequences are rendered: the paper's figures are then of other
/// images.
std::vector<ResultTable> makeTables(const std::vector<RunSummary>& runs,
                                    const std::vector<PaperValue>& paper, bool rendered);

/// A heading, the table and its note.
std::string toMarkdown(const ResultTable& table);

/// The header and the rows; fields with a comma or a quote are quoted (RFC 4180).
std::string toCsv(const ResultTable& table);

}  // namespace hmcdyn::evaluate
