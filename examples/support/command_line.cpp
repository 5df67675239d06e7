// SPDX-License-Identifier: BSD-3-Clause
#include "support/command_line.hpp"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <cstdio>
#include <exception>
#include <memory>
#include <sstream>
#include <utility>

#include <hmcdyn/version.hpp>

namespace hmcdyn::support {
namespace {

/// CLI11's, but two blanks at least between an option and its text, as help2man and our manual
/// pages want it, and no "{false}" behind a flag that switches something off.
class HelpFormatter final : public CLI::Formatter {
 public:
  explicit HelpFormatter(std::size_t width) { column_width(width); }

  std::string make_option(const CLI::Option* option, bool is_positional) const override {
    const std::string opts = make_option_opts(option);
    std::string name = make_option_name(option, is_positional);
    name = name.substr(0, name.find('{'));
    name += opts;
    std::ostringstream stream;
    CLI::detail::format_help(stream, name + " ", make_option_desc(option), get_column_width());
    std::string text = stream.str();
    if (const std::size_t blank = 2 + name.size(); text.compare(blank, 2, " \n") == 0) {
      text.erase(blank, 1);  // the text went to the next line
    }
    return text;
  }
};

void useHelpFormatter(CLI::App& app) {
  app.formatter(std::make_shared<HelpFormatter>(app.get_formatter()->get_column_width()));
  for (CLI::App* const command : app.get_subcommands({})) {
    useHelpFormatter(*command);
  }
}

/// Letters to insert, leave out, replace or swap with their neighbour (optimal string alignment;
/// Damerau 1964).
std::size_t distanceBetween(const std::string& a, const std::string& b) {
  std::vector<std::size_t> before_last;
  std::vector<std::size_t> last(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) {
    last[j] = j;
  }
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::vector<std::size_t> row(b.size() + 1, i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, replaced});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        row[j] = std::min(row[j], before_last[j - 2] + 1);
      }
    }
    before_last = std::exchange(last, std::move(row));
  }
  return last.back();
}

/// "--filter" of "--filter=hmc".
std::string nameOf(const std::string& argument) { return argument.substr(0, argument.find('=')); }

bool isNumber(const std::string& argument) {
  return argument.find_first_not_of("+-.0123456789eE") == std::string::npos;
}

void collectOptions(const CLI::App& app, std::vector<std::string>& names) {
  for (const CLI::Option* const option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) {
      names.push_back("--" + name);
    }
    for (const std::string& name : option->get_snames()) {
      names.push_back("-" + name);
    }
  }
}

/// The options of the command that was given, else of the program.
std::vector<std::string> knownOptions(const CLI::App& app) {
  std::vector<std::string> names;
  collectOptions(app, names);
  for (const CLI::App* const command : app.get_subcommands()) {
    collectOptions(*command, names);
  }
  return names;
}

std::vector<std::string> knownCommands(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* const command : app.get_subcommands({})) {
    names.push_back(command->get_name());
  }
  return names;
}

std::string complaint(const char* what, const std::string& name,
                      const std::vector<std::string>& known) {
  const std::optional<std::string> suggestion = nearest(name, known);
  return std::string("unknown ") + what + " " + name +
         (suggestion ? "; did you mean " + *suggestion + "?" : "") + "\n";
}

/// "nan", "-inf" and their like, which CLI11 takes for numbers and no range refuses.
bool isNoFiniteNumber(std::string value) {
  value.erase(0, value.find_first_not_of("+-"));
  std::transform(value.begin(), value.end(), value.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return value == "nan" || value == "inf" || value == "infinity";
}

CLI::Validator numberThat(bool (*fits)(double), const std::string& expected,
                          const std::string& name) {
  return {[fits, expected](const std::string& text) {
            double value = 0.0;
            return CLI::detail::lexical_cast(text, value) && fits(value)
                       ? std::string()
                       : "is " + text + "; expected " + expected;
          },
          name};
}

/// @throws CLI::ValidationError that names the option.
void requireFiniteNumbers(const CLI::App& app) {
  for (const CLI::Option* const option : app.get_options()) {
    for (const std::string& value : option->results()) {
      if (isNoFiniteNumber(value)) {
        throw CLI::ValidationError(option->get_name(),
                                   "is " + value + "; expected a finite number");
      }
    }
  }
  for (const CLI::App* const command : app.get_subcommands()) {
    requireFiniteNumbers(*command);
  }
}

}  // namespace

CLI::Validator aboveZero() {
  return numberThat([](double value) { return value > 0.0; }, "a number above 0", "POSITIVE");
}

CLI::Validator zeroOrMore() {
  return numberThat([](double value) { return value >= 0.0; }, "0 or more", "NONNEGATIVE");
}

CLI::Validator zeroToOne() {
  return numberThat([](double value) { return value >= 0.0 && value <= 1.0; }, "0..1", "0..1");
}

std::optional<std::string> nearest(const std::string& word,
                                   const std::vector<std::string>& candidates) {
  constexpr const char* kDashes = "-";
  const std::size_t start = std::min(word.find_first_not_of(kDashes), word.size());
  const std::size_t letters = word.size() - start;
  if (letters < 2) {
    return std::nullopt;  // every single letter is near
  }
  std::size_t least = std::max<std::size_t>(1, letters / 3) + 1;
  std::optional<std::string> best;
  for (const std::string& candidate : candidates) {
    const bool continues = candidate.compare(0, word.size(), word) == 0;
    const std::size_t distance = continues ? 1 : distanceBetween(word, candidate);
    if (distance < least) {
      least = distance;
      best = candidate;
    }
  }
  return best;
}

std::string describeUnknown(const CLI::App& app) {
  const std::vector<std::string> rest = app.remaining(true);
  const std::vector<std::string> commands = knownCommands(app);
  if (!commands.empty() && app.get_subcommands().empty() && !rest.empty() &&
      rest.front().substr(0, 1) != "-") {
    return complaint("command", rest.front(), commands);  // whose options are not known, either
  }
  std::string text;
  for (const std::string& argument : rest) {
    if (argument.size() > 1 && argument[0] == '-' && !isNumber(argument)) {
      text += complaint("option", nameOf(argument), knownOptions(app));
    }
  }
  return text;
}

std::optional<int> parseCommandLine(CLI::App& app, int argc, const char* const* argv,
                                    const std::function<void()>& check) {
  if (app.get_version_ptr() == nullptr) {
    app.set_version_flag("--version", std::string("hmcdyn ") + HMCDYN_VERSION_STRING,
                         "Print the version and exit");
  }
  useHelpFormatter(app);
  try {
    app.parse(argc, argv);
    requireFiniteNumbers(app);
    if (check) {
      check();
    }
    return std::nullopt;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) {
      return app.exit(error);
    }
    // An option that is misspelled is often one that is missing, too: say what is at the root of
    // it.
    const std::string unknown = describeUnknown(app);
    if (unknown.empty()) {
      app.exit(error);
    } else {
      std::fprintf(stderr, "%sRun with --help for more information.\n", unknown.c_str());
    }
    return kBadUsage;
  }
}

int exitCodeOf(const char* program, const std::function<void()>& work) {
  try {
    work();
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", program, error.what());
    return 1;
  }
}

}  // namespace hmcdyn::support
