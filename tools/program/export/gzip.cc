#include "tools/program/export/gzip.h"

#include <algorithm>
#include <stdexcept>

#include <zlib.h>

namespace slipbench {
namespace {

constexpr int level = 4;               // as datasets have it
constexpr int container = 16;          // of gzip, to be added to the window's bits
constexpr int memory = 8;              // zlib's default
constexpr std::size_t most = 1 << 30;  // bytes that zlib is handed at once: its counters have 32 bits
constexpr std::size_t beginning = 1 << 16;

// zlib takes its input as a pointer to what is not const, and does not change it.
Bytef* input_of(std::string_view bytes) { return reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data())); }

}  // namespace

std::string gzip(std::string_view text) {
  z_stream stream{};
  if (deflateInit2(&stream, level, Z_DEFLATED, MAX_WBITS + container, memory, Z_DEFAULT_STRATEGY) != Z_OK) {
    throw std::runtime_error("zlib: cannot begin a stream");
  }
  std::string bytes;
  std::string part(beginning, '\0');
  for (int status = Z_OK; status != Z_STREAM_END;) {
    if (stream.avail_in == 0 && !text.empty()) {
      stream.next_in = input_of(text);
      stream.avail_in = static_cast<uInt>(std::min(text.size(), most));
      text.remove_prefix(stream.avail_in);
    }
    stream.next_out = reinterpret_cast<Bytef*>(part.data());
    stream.avail_out = static_cast<uInt>(part.size());
    status = deflate(&stream, text.empty() ? Z_FINISH : Z_NO_FLUSH);
    bytes.append(part, 0, part.size() - stream.avail_out);
  }
  deflateEnd(&stream);
  return bytes;
}

std::string beginning_of_gzip(std::string_view bytes) {
  z_stream stream{};
  if (inflateInit2(&stream, MAX_WBITS + container) != Z_OK) throw std::runtime_error("zlib: cannot begin a stream");
  std::string text(beginning, '\0');
  stream.next_in = input_of(bytes);
  stream.avail_in = static_cast<uInt>(std::min(bytes.size(), most));
  stream.next_out = reinterpret_cast<Bytef*>(text.data());
  stream.avail_out = static_cast<uInt>(text.size());
  inflate(&stream, Z_SYNC_FLUSH);  // what it made of the bytes tells, whole or not
  text.resize(text.size() - stream.avail_out);
  inflateEnd(&stream);
  return text;
}

}  // namespace slipbench
