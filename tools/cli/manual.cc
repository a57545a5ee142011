#include "tools/cli/manual.h"

#include <sstream>

#include <fmt/format.h>

namespace slipbench {
namespace {

// Escapes text for roff: backslashes, hyphens, and dots and quotes at the beginning of a line.
std::string roff(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '\\') {
      result += "\\e";
    } else if (c == '-') {
      result += "\\-";
    } else {
      if ((result.empty() || result.back() == '\n') && (c == '.' || c == '\'')) result += "\\&";
      result += c;
    }
  }
  return result;
}

// Fills paragraphs and keeps indented lines unchanged.
std::string roff_footer(const std::string& footer) {
  std::istringstream lines(footer);
  std::string text;
  bool kept = false, begins = true;
  for (std::string line; std::getline(lines, line);) {
    const bool indented = line.starts_with("  ");
    if (kept && !indented) text += ".EE\n.RE\n";
    if (indented && !kept) text += ".RS\n.EX\n";
    if (!indented && !line.empty() && (begins || kept)) text += ".PP\n";
    begins = line.empty();
    kept = indented;
    if (!line.empty()) text += roff(indented ? line.substr(2) : line) + "\n";
  }
  return text + (kept ? ".EE\n.RE\n" : "");
}

std::string roff_option(const OptionHelp& option) {
  std::string names;
  for (const std::string& name : option.names) names += fmt::format("{}\\fB{}\\fR", names.empty() ? "" : ", ", roff(name));
  const std::string value = option.value.empty() ? "" : fmt::format("\\fI{}\\fR", roff(option.value));
  return fmt::format(".TP\n{}{}{}\n{}\n", names, names.empty() || value.empty() ? "" : " ", value, roff(option.help));
}

std::string roff_command(const CommandHelp& command) {
  std::string text = fmt::format(".SS slipbench {}\n{}.\n", roff(command.name), roff(command.summary));
  for (const OptionHelp& argument : command.arguments) text += roff_option(argument);
  for (const OptionHelp& option : command.options) text += roff_option(option);
  text += roff_footer(command.footer);
  for (const CommandHelp& below : command.commands) text += roff_command(below);
  return text;
}

}  // namespace

std::string manual_page(const CommandHelp& program, std::string_view version) {
  std::string text = fmt::format(
      ".TH SLIPBENCH 1 \"\" \"slipbench {}\"\n.SH NAME\nslipbench \\- physics testbench for tactile slip detection\n"
      ".SH SYNOPSIS\n.B slipbench\n.I COMMAND\n.RI [ OPTIONS ]\n.SH DESCRIPTION\n{}\n",
      roff(version), roff(program.summary));
  text += roff_footer(program.footer) + ".SH OPTIONS\n";
  for (const OptionHelp& option : program.options) text += roff_option(option);
  text += ".SH COMMANDS\n";
  for (const CommandHelp& command : program.commands) text += roff_command(command);
  return text;
}

}  // namespace slipbench
