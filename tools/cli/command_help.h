// The command table as texts, from which completion scripts and the manual page are made.
#pragma once

#include <string>
#include <vector>

namespace slipbench {

// Kinds of values that completion can offer for an option or an argument.
struct AllowedValues {
  enum class Kind {
    none,     // it takes no value
    text,     // any text
    words,    // one of `words`
    files,    // a file whose name ends with `ending`; empty: any file
    folders,  // a folder
  };
  Kind kind = Kind::text;
  std::vector<std::string> words = {};
  std::string ending = {};
};

// An option or a positional argument.
struct OptionHelp {
  std::vector<std::string> names = {};  // "-o", "--output"; empty: an argument
  std::string value = {};               // name of its value in the help: "FILE.h5"; empty: it takes none
  std::string help = {};
  AllowedValues allowed = {};
  bool repeated = false;  // takes several values
};

// A command, or the program itself.
struct CommandHelp {
  std::string name = {};     // words after the program's name: "hd replay"; empty: the program
  std::string summary = {};  // its line in the list of commands
  std::string footer = {};   // text below the options in its help
  std::vector<OptionHelp> options = {};
  std::vector<OptionHelp> arguments = {};
  std::vector<CommandHelp> commands = {};
};

}  // namespace slipbench
