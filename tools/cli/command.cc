#include "tools/cli/command.h"

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include <fmt/format.h>

#include "tools/cli/terminal.h"
#include "tools/files/reject.h"

namespace slipbench {

void Command::print_status(const std::string& what) const {
  if (!silent()) say(stderr, fmt::format("slipbench: {}\n", what));
}

std::string Command::stream(const std::string& ending) {
  streamed_ = std::make_shared<const ScratchFolder>();
  return stream_path_ = streamed_->file("output" + ending);
}

void Command::send_stream() {
  if (!streamed_) return;
  take_stdout_back();
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(stream_path_.c_str(), "rb"), &std::fclose);
  streamed_.reset();  // removes the file's name: a closed pipe may end the program while it writes
  if (!file) return;
  std::array<char, 65536> block{};
  while (const std::size_t count = std::fread(block.data(), 1, block.size(), file.get())) {
    if (std::fwrite(block.data(), 1, count, stdout) != count) reject("cannot write to standard output: {}", std::strerror(errno));
  }
  if (std::ferror(file.get()) != 0) reject("cannot read the temporary file of standard output: {}", std::strerror(errno));
}

}  // namespace slipbench
