#include "tools/cli/completion.h"

#include <algorithm>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace slipbench {
namespace {

using Kind = AllowedValues::Kind;

// The program, its commands, and the commands below these.
std::vector<const CommandHelp*> all_commands(const CommandHelp& program) {
  std::vector<const CommandHelp*> commands{&program};
  for (std::size_t i = 0; i < commands.size(); ++i) {
    for (const CommandHelp& below : commands[i]->commands) commands.push_back(&below);
  }
  return commands;
}

std::string last_word(const std::string& name) { return name.substr(name.rfind(' ') + 1); }

std::string replace_all(std::string text, std::string_view from, std::string_view to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
  return text;
}

// Quotes a text for bash and zsh with single quotes.
std::string quoted(const std::string& text) { return "'" + replace_all(text, "'", R"('\'')") + "'"; }

// Returns the first clause of a help text, which fits beside a name in a list.
std::string short_help(const std::string& help) {
  const std::size_t end = std::min(help.find_first_of(";("), help.find(": "));
  std::string text = help.substr(0, end);
  while (text.ends_with(' ')) text.pop_back();
  return text;
}

std::vector<std::string> names_of(const std::vector<OptionHelp>& options, bool with_value) {
  std::vector<std::string> names;
  for (const OptionHelp& option : options) {
    if (!with_value || option.allowed.kind != Kind::none) names.insert(names.end(), option.names.begin(), option.names.end());
  }
  return names;
}

std::vector<std::string> words_below(const CommandHelp& command) {
  std::vector<std::string> words;
  for (const CommandHelp& below : command.commands) words.push_back(last_word(below.name));
  return words;
}

// Returns the code that completes a value: a call of one of the script's functions.
std::string bash_value(const AllowedValues& allowed) {
  switch (allowed.kind) {
    case Kind::words: return "_slipbench_words " + quoted(fmt::format("{}", fmt::join(allowed.words, " ")));
    case Kind::files: return "_slipbench_files " + quoted(allowed.ending);
    case Kind::folders: return "_slipbench_folders";
    case Kind::none:
    case Kind::text: return ":";
  }
  throw std::logic_error("no such kind of values");
}

std::string bash_command(const CommandHelp& command) {
  std::string options, arguments;
  for (const OptionHelp& option : command.options) {
    if (option.allowed.kind == Kind::none) continue;
    options += fmt::format("        {}) {}; return ;;\n", fmt::join(option.names, "|"), bash_value(option.allowed));
  }
  for (std::size_t i = 0; i < command.arguments.size(); ++i) {
    const OptionHelp& argument = command.arguments[i];
    arguments += fmt::format("        {}) {} ;;\n", argument.repeated ? "*" : std::to_string(i), bash_value(argument.allowed));
    if (argument.repeated) break;
  }
  std::string text = fmt::format("    {})\n", quoted(command.name));
  if (!options.empty()) text += fmt::format("      case $option in\n{}      esac\n", options);
  text += fmt::format("      if [[ $word == -* ]]; then _slipbench_words {}; return; fi\n",
                      quoted(fmt::format("{}", fmt::join(names_of(command.options, false), " "))));
  if (!command.commands.empty()) {
    text += fmt::format("      _slipbench_words {}\n", quoted(fmt::format("{}", fmt::join(words_below(command), " "))));
  }
  if (!arguments.empty()) text += fmt::format("      case $place in\n{}      esac\n", arguments);
  return text + "      ;;\n";
}

// bash splits --option=value into three words.
constexpr std::string_view bash_head = R"(# Completion of slipbench for bash, made by: slipbench completion bash
_slipbench_words() { mapfile -t COMPREPLY < <(compgen -W "$1" -- "$word"); }
_slipbench_folders() {
  compopt -o filenames
  mapfile -t COMPREPLY < <(compgen -d -- "$word")
}
_slipbench_files() {
  compopt -o filenames
  mapfile -t COMPREPLY < <(compgen -f -X "!*$1" -- "$word"; if [[ -n $1 ]]; then compgen -d -- "$word"; fi)
}
_slipbench() {
  local word=${COMP_WORDS[COMP_CWORD]} option='' command='' place=0 i=1 end=$COMP_CWORD
  COMPREPLY=()
  if [[ $word == = ]]; then
    word=''
    end=$((end - 1))
  elif [[ ${COMP_WORDS[COMP_CWORD - 1]} == = ]]; then
    end=$((end - 2))
  fi
  if ((end < COMP_CWORD)); then option=${COMP_WORDS[end]}; fi
  for (( ; i < end; ++i)); do
    local given=${COMP_WORDS[i]}
    case "$command $given" in
)";

constexpr std::string_view bash_middle = R"(      *)
        if [[ ${COMP_WORDS[i + 1]} == = ]]; then
          i=$((i + 2))
        elif [[ $given == -* ]]; then
          case "$command $given" in
)";

constexpr std::string_view bash_tail = R"(              if ((i + 1 == end && end == COMP_CWORD)); then option=$given; fi
              i=$((i + 1))
              ;;
          esac
        else
          place=$((place + 1))
        fi
        ;;
    esac
  done
  case $command in
)";

std::string bash_script(const CommandHelp& program) {
  std::string known, valued, commands;
  for (const CommandHelp* command : all_commands(program)) {
    for (const CommandHelp& below : command->commands)
      known += fmt::format("      {}) command={} ;;\n", quoted(command->name + " " + last_word(below.name)), quoted(below.name));
    for (const std::string& name : names_of(command->options, true))
      valued += (valued.empty() ? "" : " | ") + quoted(command->name + " " + name);
    commands += bash_command(*command);
  }
  return fmt::format("{}{}{}            {})\n{}{}  esac\n}}\ncomplete -F _slipbench slipbench\n", bash_head, known, bash_middle,
                     valued, bash_tail, commands);
}

std::string zsh_value(const OptionHelp& option) {
  const std::string name = replace_all(option.value, ":", "\\:");
  switch (option.allowed.kind) {
    case Kind::none: return "";
    case Kind::text: return fmt::format(":{}: ", name);
    case Kind::words: return fmt::format(":{}:({})", name, fmt::join(option.allowed.words, " "));
    case Kind::files:
      return option.allowed.ending.empty() ? fmt::format(":{}:_files", name)
                                           : fmt::format(":{}:_files -g \"*{}\"", name, option.allowed.ending);
    case Kind::folders: return fmt::format(":{}:_files -/", name);
  }
  throw std::logic_error("no such kind of values");
}

std::string zsh_help(const std::string& help) {
  std::string text = short_help(help);
  for (const char* special : {"\\", "[", "]", ":"}) text = replace_all(text, special, std::string("\\") + special);
  return text;
}

std::string zsh_options(const CommandHelp& command, const std::string& margin) {
  std::string text;
  for (const OptionHelp& option : command.options) {
    for (const std::string& name : option.names) {
      const bool equals = name.starts_with("--") && option.allowed.kind != Kind::none;
      const std::string others = option.repeated ? "*" : fmt::format("({})", fmt::join(option.names, " "));
      text += fmt::format(
          " \\\n{}{}", margin,
          quoted(fmt::format("{}{}{}[{}]{}", others, name, equals ? "=" : "", zsh_help(option.help), zsh_value(option))));
    }
  }
  return text;
}

// The function that completes the words of `command`, and those of the commands below it.
std::string zsh_function(const CommandHelp& command) {
  const std::string function = "_slipbench" + (command.name.empty() ? "" : "_" + replace_all(command.name, " ", "_"));
  std::string text = fmt::format("{}() {{\n", function);
  if (command.commands.empty()) {
    text += "  _arguments" + zsh_options(command, "    ");
    for (std::size_t i = 0; i < command.arguments.size(); ++i) {
      const OptionHelp& argument = command.arguments[i];
      const std::string place = argument.repeated ? "*" : std::to_string(i + 1);
      text += fmt::format(" \\\n    {}", quoted(place + zsh_value(argument)));
    }
    return text + "\n}\n";
  }
  std::string names, cases;
  for (const CommandHelp& below : command.commands) {
    const std::string word = last_word(below.name);
    names += fmt::format("    {}\n", quoted(word + ":" + replace_all(below.summary, ":", "\\:")));
    cases += fmt::format("        {}) {}_{} ;;\n", word, function, word);
  }
  text += fmt::format("  local state line\n  local -a commands=(\n{}  )\n", names);
  text += "  _arguments -C" + zsh_options(command, "    ") + " \\\n    '1:COMMAND:->command' \\\n    '*::argument:->argument'\n";
  text += "  case $state in\n    command) _describe command commands ;;\n    argument)\n      case $line[1] in\n" + cases;
  text += "      esac\n      ;;\n  esac\n}\n";
  for (const CommandHelp& below : command.commands) text += zsh_function(below);
  return text;
}

std::string zsh_script(const CommandHelp& program) {
  return "#compdef slipbench\n# Completion of slipbench for zsh, made by: slipbench completion zsh\n" + zsh_function(program) +
         "if [[ $funcstack[1] == _slipbench ]]; then _slipbench \"$@\"; else compdef _slipbench slipbench; fi\n";
}

std::string fish_quoted(const std::string& text) { return "'" + replace_all(replace_all(text, "\\", "\\\\"), "'", "\\'") + "'"; }

std::string fish_value(const AllowedValues& allowed) {
  switch (allowed.kind) {
    case Kind::none: return "";
    case Kind::text: return " -x";
    case Kind::words: return fmt::format(" -x -a {}", fish_quoted(fmt::format("{}", fmt::join(allowed.words, " "))));
    case Kind::files:
      return allowed.ending.empty() ? " -r -F" : fmt::format(" -x -k -a '(__fish_complete_suffix {})'", allowed.ending);
    case Kind::folders: return " -x -a '(__fish_complete_directories)'";
  }
  throw std::logic_error("no such kind of values");
}

std::string fish_command(const CommandHelp& command) {
  const std::string line = fmt::format("complete -c slipbench -n \"__slipbench_at {}\"", fish_quoted(command.name));
  std::string text;
  for (const CommandHelp& below : command.commands)
    text += fmt::format("{} -a {} -d {}\n", line, last_word(below.name), fish_quoted(below.summary));
  for (const OptionHelp& option : command.options) {
    text += line;
    for (const std::string& name : option.names)
      text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
    text += fmt::format("{} -d {}\n", fish_value(option.allowed), fish_quoted(short_help(option.help)));
  }
  // fish does not number arguments, so each position offers the values of all arguments.
  for (const OptionHelp& argument : command.arguments) {
    if (argument.allowed.kind == Kind::files && argument.allowed.ending.empty()) text += line + " -F\n";
    if (argument.allowed.kind != Kind::text) {
      const std::string value = fish_value(argument.allowed);
      const std::size_t list = value.find("-a ");
      if (list != std::string::npos) text += fmt::format("{} -k {}\n", line, value.substr(list));
    }
  }
  return text;
}

std::string fish_script(const CommandHelp& program) {
  std::string names, text;
  for (const CommandHelp* command : all_commands(program)) {
    if (!command->name.empty()) names += " " + fish_quoted(command->name);
    text += fish_command(*command);
  }
  return fmt::format(R"(# Completion of slipbench for fish, made by: slipbench completion fish
function __slipbench_at
    set -l command ''
    for word in (commandline -opc)[2..]
        set -l longer (string trim "$command $word")
        if contains -- $longer{}
            set command $longer
        end
    end
    test "$command" = "$argv"
end
complete -c slipbench -f
)",
                     names) +
         text;
}

}  // namespace

std::string completion_script(const CommandHelp& program, std::string_view shell) {
  if (shell == "bash") return bash_script(program);
  if (shell == "fish") return fish_script(program);
  if (shell == "zsh") return zsh_script(program);
  throw std::logic_error("no such shell");
}

}  // namespace slipbench
