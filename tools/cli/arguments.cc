#include "tools/cli/arguments.h"

#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <stdexcept>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "sim/core/parameters.h"
#include "tools/cli/command.h"
#include "tools/cli/program.h"
#include "tools/cli/terminal.h"
#include "tools/files/project/project_file.h"
#include "tools/files/reject.h"

namespace slipbench {
namespace {

constexpr std::string_view program_footer = R"(
Exit status: 0 success, 1 a check failed, 2 bad input, 130 interrupted. Errors go to stderr.
`slipbench help COMMAND` explains a command. Start with: slipbench run scenes/papillarray/stage.yaml)";

// A footer begins with a line end, which only serves the layout of the source.
std::string without_first_line_end(std::string_view footer) { return std::string(footer.substr(1)); }

// Ending of the file in a usage: ".h5" for "-o,--output FILE.h5".
std::string ending_of(const std::string& usage) {
  const std::size_t dot = usage.find('.');
  return dot == std::string::npos ? "" : usage.substr(dot);
}

// Name of an option in messages: "-o" for "-o,--output FILE.h5".
std::string first_name(const std::string& usage) { return usage.substr(0, usage.find_first_of(", ")); }

template <class Target>
CLI::Option* add_option(CLI::App& app, const std::string& usage, Target& target, const std::string& help) {
  const std::size_t end = std::min(usage.find(' '), usage.size());
  return app.add_option(usage.substr(0, end), target, help)->option_text(end == usage.size() ? " " : usage.substr(end + 1));
}

Override parse_override(const std::string& command, const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) {
    reject("{}: --set {}: expected key=value, such as --set motion.speed=\"8 mm/s\"", command, quote(text));
  }
  return {text.substr(0, equals), text.substr(equals + 1)};
}

// True for a scene key followed by '=': a further value of --set.
bool looks_like_override(const std::string& word) {
  const auto is_key_character = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '.';
  };
  const std::size_t equals = word.find('=');
  return equals != std::string::npos && equals > 0 &&
         std::all_of(word.begin(), word.begin() + static_cast<std::ptrdiff_t>(equals), is_key_character);
}

// Turns "--set a=1 b=2 SCENE" into "--set a=1 --set b=2 SCENE", which shows where the values end.
std::vector<std::string> repeat_set(const std::vector<std::string>& words) {
  std::vector<std::string> result;
  bool inside = false;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (inside && looks_like_override(words[i])) result.emplace_back("--set");
    result.push_back(words[i]);
    if (words[i] == "--set" && i + 1 < words.size()) {
      result.push_back(words[++i]);
      inside = true;
    } else {
      inside = inside && looks_like_override(words[i]);
    }
  }
  return result;
}

std::vector<std::string> names_below(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) names.push_back(command->get_name());
  return names;
}

// `above`: "hd: " for a command of hd, empty for a command of the program.
[[noreturn]] void refuse_command(const std::string& above, const std::string& word, const std::vector<std::string>& names) {
  if (names.empty()) reject("{}unknown command {}; there are no subcommands", above, quote(word));
  reject("{}unknown command {}{} commands: {}", above, quote(word), suggestion(word, names), fmt::join(names, ", "));
}

void refuse_unknown_command(const std::vector<std::string>& words, const std::vector<std::string>& names) {
  const auto word = std::ranges::find_if(words, [](const std::string& a) { return !a.starts_with('-'); });
  if (word != words.end() && std::ranges::find(names, *word) == names.end()) refuse_command("", *word, names);
}

}  // namespace

Arguments::Arguments(CLI::App& app, Command* command, const Arguments* parent, bool& json)
    : app_(&app), command_(command), parent_(parent), name_(parent == nullptr ? "" : parent->name_), json_(&json) {
  flag("--json", json, "Print a single JSON object on stdout");
}

void Arguments::about(const std::string& name, const std::string& summary, std::string_view footer) {
  app_->name(name)->description(summary)->footer(without_first_line_end(footer));
  name_ += (name_.empty() ? "" : " ") + name;
}

Arguments& Arguments::flag(const std::string& usage, bool& value, const std::string& help) {
  last_ = app_->add_flag(usage, value, help);
  return *this;
}

Arguments& Arguments::text(const std::string& usage, std::string& value, const std::string& help) {
  last_ = add_option(*app_, usage, value, help);
  return *this;
}

Arguments& Arguments::texts(const std::string& usage, std::vector<std::string>& values, const std::string& help) {
  last_ = add_option(*app_, usage, values, help);
  if (usage.starts_with('-')) last_->delimiter(',')->allow_extra_args(false);
  return *this;
}

Arguments& Arguments::lines(const std::string& usage, std::vector<std::string>& values, const std::string& help) {
  last_ = add_option(*app_, usage, values, help)->allow_extra_args(false);
  return *this;
}

Arguments& Arguments::input(const std::string& usage, std::string& value, const std::string& help, const std::string& ending) {
  text(usage, value, help);
  values_[last_] = {AllowedValues::Kind::files, {}, ending};
  return *this;
}

Arguments& Arguments::inputs(const std::string& usage, std::vector<std::string>& values, const std::string& help,
                             const std::string& ending) {
  texts(usage, values, help);
  values_[last_] = {AllowedValues::Kind::files, {}, ending};
  return *this;
}

Arguments& Arguments::scene(const std::string& usage, std::string& value, const std::string& help) {
  input(usage, value, help, ".yaml");
  readers_.emplace_back([&value] { value = scene_path(value); });
  return *this;
}

Arguments& Arguments::scenes(const std::string& usage, std::vector<std::string>& values, const std::string& help) {
  inputs(usage, values, help, ".yaml");
  readers_.emplace_back([&values] { std::ranges::transform(values, values.begin(), scene_path); });
  return *this;
}

Arguments& Arguments::file(const std::string& usage, std::string& value, const std::string& help) {
  target(usage, value, help, "file");
  values_[last_] = {AllowedValues::Kind::files, {}, ending_of(usage)};
  return *this;
}

Arguments& Arguments::output(const std::string& usage, std::string& value, const std::string& help, const std::string& ending) {
  target(usage, value, help, "file", ending.empty() ? ending_of(usage) : ending);
  values_[last_] = {AllowedValues::Kind::files, {}, ending_of(usage)};
  return *this;
}

Arguments& Arguments::folder(const std::string& usage, std::string& value, const std::string& help) {
  target(usage, value, help, "folder");
  values_[last_] = {AllowedValues::Kind::folders, {}, ""};
  return *this;
}

Arguments& Arguments::target(const std::string& usage, std::string& value, const std::string& help, const char* kind,
                             const std::string& stream_ending) {
  return read(usage, help, [=, this, &value](const std::string& text) {
    const std::string option = first_name(usage);
    if (text.empty()) reject("{}: {} needs a {} name", name_, option, kind);
    if (text != "-") {
      value = text;
      return;
    }
    if (stream_ending.empty()) {
      reject("{}: {} - means standard output, which cannot take this result; allowed: a {} name, such as ./-", name_, option,
             kind);
    }
    if (*json_) reject("{}: {} - and --json both write to standard output; allowed: one of them", name_, option);
    if (stream_ending == ".h5" && isatty(STDOUT_FILENO) == 1) {
      reject("{}: {} - writes HDF5, and standard output is a terminal here; allowed: a file or a pipe, as in {} - > FILE.h5",
             name_, option, option);
    }
    value = command_->stream(stream_ending);
  });
}

Arguments& Arguments::read(const std::string& usage, const std::string& help, std::function<void(const std::string&)> reader) {
  const auto text = std::make_shared<std::string>();
  last_ = add_option(*app_, usage, *text, help);
  readers_.emplace_back([text, reader = std::move(reader), option = last_] {
    if (!option->empty()) reader(*text);
  });
  return *this;
}

std::string Arguments::with_names(std::string help, const std::vector<std::string>& names) {
  const std::size_t place = help.find("{}");
  return place == std::string::npos ? help : help.replace(place, 2, fmt::format("{}", fmt::join(names, ", ")));
}

Arguments& Arguments::sets(std::vector<Override>& values, const std::string& help) {
  const auto sets = std::make_shared<std::vector<std::string>>();
  last_ = add_option(*app_, "--set KEY=VALUE ...", *sets, help + "; repeatable")->allow_extra_args(false);
  readers_.emplace_back([this, sets, &values] {
    for (const std::string& set : *sets) values.push_back(parse_override(name_, set));
  });
  return *this;
}

Arguments& Arguments::overrides(std::vector<Override>& values, std::optional<std::uint64_t>& seed) {
  sets(values, "Set a value of the scene, e.g. motion.speed=\"8 mm/s\"; KEY=null removes it");
  return number("--seed N", seed, "Seed of all random draws (default: the scene's own)", 0);
}

Arguments& Arguments::required() {
  if (last_->get_positional()) {
    last_->required();
  } else {  // read in order, so that an earlier wrong value is reported first
    readers_.emplace_back([this, option = last_] {
      if (option->empty()) reject("{}: --{} is required", name_, option->get_lnames().front());
    });
  }
  return *this;
}

Arguments& Arguments::offers(std::function<std::vector<std::string>()> words) {
  words_[last_] = std::move(words);
  return *this;
}

void Arguments::command(Command& command) {
  CLI::App* const app = app_->add_subcommand("", "");
  command.declare(*commands_.emplace_back(std::make_unique<Arguments>(*app, &command, this, *json_)));
}

const Arguments& Arguments::program() const { return parent_ == nullptr ? *this : parent_->program(); }

std::vector<std::string> Arguments::command_names() const { return names_below(*program().app_); }

CommandHelp Arguments::table() const { return program().described(); }

CommandHelp Arguments::described() const {
  CommandHelp command{.name = name_, .summary = app_->get_description(), .footer = app_->get_footer()};
  for (const CLI::Option* option : std::as_const(*app_).get_options()) {
    OptionHelp help{.help = option->get_description(), .repeated = option->get_expected_max() > 1};
    for (const std::string& name : option->get_snames()) help.names.push_back("-" + name);
    for (const std::string& name : option->get_lnames()) help.names.push_back("--" + name);
    if (option->get_items_expected_max() == 0) help.allowed.kind = AllowedValues::Kind::none;
    if (const auto values = values_.find(option); values != values_.end()) help.allowed = values->second;
    if (const auto words = words_.find(option); words != words_.end()) {
      help.allowed = {AllowedValues::Kind::words, words->second(), ""};
    }
    const bool argument = option->get_positional();
    if (help.allowed.kind != AllowedValues::Kind::none)
      help.value = argument ? option->get_name(true) : option->get_option_text();
    (argument ? command.arguments : command.options).push_back(std::move(help));
  }
  for (const auto& below : commands_) command.commands.push_back(below->described());
  return command;
}

std::string Arguments::help_of(const std::vector<std::string>& path) const {
  const Arguments* command = &program();
  std::string above = command->app_->get_name();
  for (const std::string& word : path) {
    const auto below =
        std::ranges::find_if(command->commands_, [&word](const auto& found) { return found->app_->get_name() == word; });
    if (below == command->commands_.end())
      refuse_command(command->name_.empty() ? "" : command->name_ + ": ", word, names_below(*command->app_));
    command = below->get();
    above += " " + word;
  }
  return command->app_->get_formatter()->make_help(command->app_, above, CLI::AppFormatMode::Normal);
}

const Arguments& Arguments::chosen() const {
  const auto below = std::ranges::find_if(commands_, [](const auto& command) { return command->app_->parsed(); });
  return below == commands_.end() ? *this : (*below)->chosen();
}

Command* Arguments::read_values() const {
  for (const auto& reader : readers_) reader();
  return command_;
}

InputError Arguments::unexpected(const std::string& word) const {
  const std::string prefix = name_.empty() ? "" : name_ + ": ";
  if (!word.starts_with('-')) {
    return InputError(fmt::format("{}unexpected argument {}; see slipbench {} --help", prefix, quote(word), name_));
  }
  std::vector<std::string> names;
  for (const CLI::Option* option : std::as_const(*app_).get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  if (names.empty())
    return InputError(fmt::format("unknown option {} before '{}'; the options of a command follow its name", quote(word), name_));
  const std::string name = word.substr(0, word.find('='));
  return InputError(
      fmt::format("{}unknown option {}{} options: {}", prefix, quote(name), suggestion(name, names), fmt::join(names, ", ")));
}

std::uint64_t Arguments::whole_number(const std::string& usage, const std::string& text, std::uint64_t min,
                                      std::uint64_t max) const {
  std::uint64_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, status] = std::from_chars(text.data(), end, value);
  if (status != std::errc{} || stop != end || value < min || value > max) {
    refuse(usage, text, fmt::format("; allowed: a whole number from {} to {}", min, max));
  }
  return value;
}

double Arguments::positive_quantity(const std::string& usage, const std::string& text, Quantity quantity) const {
  ParameterSpec spec;
  spec.name = first_name(usage);
  spec.quantity = quantity;
  spec.range = positive;
  try {
    return std::get<double>(parse_scalar(spec, text));
  } catch (const std::invalid_argument& error) {
    reject("{}: {}: {}", name_, spec.name, error.what());
  }
}

void Arguments::refuse(const std::string& usage, const std::string& text, const std::string& allowed) const {
  reject("{}: {} is {}{}", name_, first_name(usage), quote(text), allowed);
}

Request parse_command_line(const Commands& commands, const std::vector<std::string>& words) {
  Request request;
  CLI::App app{"A physics testbench for tactile slip detection.", "slipbench"};
  app.footer(without_first_line_end(program_footer));
  app.get_formatter()->column_width(26);
  app.add_flag("--version", request.version, "Print the version");
  Arguments program(app, nullptr, nullptr, request.json);
  for (const auto& command : commands) program.command(*command);
  app.require_subcommand(0, 1);  // what follows a command is its own, a command's name too
  const std::vector<std::string> names = names_below(app);
  refuse_unknown_command(words, names);
  if (words.empty()) {
    request.help = app.help();
    return request;
  }

  const auto prefix = [&program] {
    const std::string& name = program.chosen().name();
    return name.empty() ? name : name + ": ";
  };
  std::vector<std::string> reversed = repeat_set(words);
  std::ranges::reverse(reversed);  // CLI11 reads them from the back
  try {
    app.parse(reversed);
  } catch (const CLI::CallForHelp&) {
    request.help = app.help();
    return request;
  } catch (const CLI::ExtrasError&) {
    throw program.chosen().unexpected(app.remaining(true).front());
  } catch (const CLI::ArgumentMismatch& error) {
    const std::string message = error.what();  // CLI11 reports "--output: 1 required TEXT missing"
    reject("{}{} needs a value", prefix(), message.substr(0, message.find(':')));
  } catch (const CLI::ParseError& error) {
    throw InputError(prefix() + error.what());
  }
  if (request.version) return request;
  request.command = program.chosen().read_values();
  if (request.command == nullptr) reject("no command given; commands: {}", fmt::join(names, ", "));
  request.command->json = request.json;
  return request;
}

}  // namespace slipbench
