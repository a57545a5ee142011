// Declares the options of commands.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/core/choice.h"
#include "sim/core/error.h"
#include "sim/core/quantity.h"
#include "sim/scene/parser.h"
#include "tools/cli/command_help.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace slipbench {

class Command;

// Options of one command, and its subcommands.
//
// `usage` is shown in the help: "--seed N", "-o,--output FILE.h5", or a name such as "SCENE" for a
// positional argument. `value` is unchanged if the option is not given; it must outlive this
// object. Values are read in the order of declaration, after all words are assigned. A bad value
// throws InputError: "run: --jobs is '0'; allowed: a whole number from 1 to 1024".
class Arguments {
 public:
  // `app`: CLI11's view of the command, or of the program if `command` is null. `parent`: the
  // parent command, which must outlive this object; null: the program. `json`: set by --json of any
  // command.
  Arguments(CLI::App& app, Command* command, const Arguments* parent, bool& json);

  // Sets the command's name ("run"), its line in the list of commands, and the text below the
  // options in its help; the footer's first line is empty. Call it before other declarations.
  void about(const std::string& name, const std::string& summary, std::string_view footer);

  // Becomes true if given.
  Arguments& flag(const std::string& usage, bool& value, const std::string& help);
  // Any text.
  Arguments& text(const std::string& usage, std::string& value, const std::string& help);
  // Several texts: an argument takes all words, an option takes one word and splits it at commas.
  Arguments& texts(const std::string& usage, std::vector<std::string>& values, const std::string& help);
  // An option that may be repeated, one text each.
  Arguments& lines(const std::string& usage, std::vector<std::string>& values, const std::string& help);
  // Name of a file to read, or several names. `ending`: the ending of the names that completion
  // offers. Empty: any ending.
  Arguments& input(const std::string& usage, std::string& value, const std::string& help, const std::string& ending = "");
  Arguments& inputs(const std::string& usage, std::vector<std::string>& values, const std::string& help,
                    const std::string& ending = "");
  // As input(), for scenes: the name of a file or of a shipped scene (tools/files/project).
  Arguments& scene(const std::string& usage, std::string& value, const std::string& help);
  Arguments& scenes(const std::string& usage, std::vector<std::string>& values, const std::string& help);
  // Name of a file or folder to write: not empty. A file called '-' is written as './-', since '-'
  // stands for standard output, which output() alone accepts.
  Arguments& file(const std::string& usage, std::string& value, const std::string& help);
  // As file(), for a single file that may also go to standard output. `ending`: of the file; empty:
  // that of the name in `usage`.
  Arguments& output(const std::string& usage, std::string& value, const std::string& help, const std::string& ending = "");
  Arguments& folder(const std::string& usage, std::string& value, const std::string& help);
  // A whole number from `min` to `max`, into an integer or an optional one.
  template <class Value>
  Arguments& number(const std::string& usage, Value& value, const std::string& help, std::uint64_t min,
                    std::uint64_t max = std::numeric_limits<std::uint64_t>::max()) {
    return read(usage, help, [=, this, &value](const std::string& text) { value = whole_number(usage, text, min, max); });
  }
  // A positive quantity, in SI or with its unit, into a double or an optional one.
  template <class Value>
  Arguments& quantity(const std::string& usage, Value& value, const std::string& help, Quantity quantity) {
    return read(usage, help, [=, this, &value](const std::string& text) { value = positive_quantity(usage, text, quantity); });
  }
  // One of the names of a table (sim/core/choice.h), which must outlive this object. They
  // replace {} in `help`.
  template <class Value, class Words>
  Arguments& word(const std::string& usage, Value& value, const std::string& help, const Words& words) {
    return read(usage, with_names(help, choice_names(words)),
                [=, this, &value, &words](const std::string& text) {
                  const auto found = choice_value(words, text);
                  if (!found) refuse(usage, text, allowed_names(text, choice_names(words)));
                  value = *found;
                })
        .offers([&words] { return choice_names(words); });
  }
  // Any other value: `reader` receives the text and throws InputError for an invalid one.
  Arguments& read(const std::string& usage, const std::string& help, std::function<void(const std::string&)> reader);
  // Replaces {} in `help` by the names, if present.
  static std::string with_names(std::string help, const std::vector<std::string>& names);

  // Options shared by several commands: --set, whose keys `help` explains; --set and --seed of a
  // scene; --jobs from 1 to 1024.
  Arguments& sets(std::vector<Override>& values, const std::string& help);
  Arguments& overrides(std::vector<Override>& values, std::optional<std::uint64_t>& seed);
  template <class Value>
  Arguments& jobs(Value& value, const std::string& help = "Worker threads, 1 to 1024 (default: one per hardware thread)") {
    // No machine can use more threads: each reserves megabytes of address space, so that thousands
    // fail to start.
    return number("--jobs N", value, help, 1, 1024);
  }

  // Makes the last declaration mandatory.
  Arguments& required();
  // Declares the values that completion offers for the last declaration. `words` is called only
  // when a completion script is made.
  Arguments& offers(std::function<std::vector<std::string>()> words);
  // Calls `rule` after all earlier declarations are read: for rules about several options.
  void then(std::function<void()> rule) { readers_.push_back(std::move(rule)); }

  // Adds a subcommand, which must outlive this object.
  void command(Command& command);

  // "run", "hd replay"; empty for the program itself.
  [[nodiscard]] const std::string& name() const { return name_; }
  // Returns the help of the command that `path` names ("hd", "replay"), or the program's help if it
  // is empty, as `slipbench COMMAND --help` prints it. Throws InputError for an unknown command,
  // with the nearest name.
  [[nodiscard]] std::string help_of(const std::vector<std::string>& path) const;
  // The whole command table, from the program down, for texts that are made from it.
  [[nodiscard]] CommandHelp table() const;
  // Names of the program's commands.
  [[nodiscard]] std::vector<std::string> command_names() const;
  // The innermost command named on the command line.
  [[nodiscard]] const Arguments& chosen() const;
  // Reads the values into the command and returns it; null for the program itself.
  [[nodiscard]] Command* read_values() const;
  // InputError for a word that matches no argument, with the nearest option.
  [[nodiscard]] InputError unexpected(const std::string& word) const;

 private:
  std::uint64_t whole_number(const std::string& usage, const std::string& text, std::uint64_t min, std::uint64_t max) const;
  double positive_quantity(const std::string& usage, const std::string& text, Quantity quantity) const;
  [[noreturn]] void refuse(const std::string& usage, const std::string& text, const std::string& allowed) const;
  Arguments& target(const std::string& usage, std::string& value, const std::string& help, const char* kind,
                    const std::string& stream_ending = "");
  [[nodiscard]] const Arguments& program() const;
  [[nodiscard]] CommandHelp described() const;

  CLI::App* app_;
  Command* command_;
  const Arguments* parent_;
  std::string name_;
  bool* json_;
  CLI::Option* last_ = nullptr;
  std::map<const CLI::Option*, AllowedValues> values_;                             // of options that take files
  std::map<const CLI::Option*, std::function<std::vector<std::string>()>> words_;  // of options that take one of some words
  std::vector<std::function<void()>> readers_;
  std::vector<std::unique_ptr<Arguments>> commands_;
};

}  // namespace slipbench
