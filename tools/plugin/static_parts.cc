// Third-party code that the plugin's libraries contain besides libyaml-cpp.a: {fmt}, of which
// Debian has no static library, as in its src/format.cc; and a variable of libc that libyaml-cpp.a,
// compiled for programs, accesses without the relocation table that a shared library needs. Its
// value zero means that there may be several threads.
#include <fmt/format-inl.h>

extern "C" {
[[gnu::visibility("hidden")]] char __libc_single_threaded = 0;
}

FMT_BEGIN_NAMESPACE
namespace detail {

template FMT_API auto dragonbox::to_decimal(float x) noexcept -> dragonbox::decimal_fp<float>;
template FMT_API auto dragonbox::to_decimal(double x) noexcept -> dragonbox::decimal_fp<double>;
template FMT_API locale_ref::locale_ref(const std::locale& loc);
template FMT_API auto locale_ref::get<std::locale>() const -> std::locale;
template FMT_API auto thousands_sep_impl(locale_ref) -> thousands_sep_result<char>;
template FMT_API auto decimal_point_impl(locale_ref) -> char;
template FMT_API void buffer<char>::append(const char*, const char*);
template FMT_API void vformat_to(buffer<char>&, string_view, basic_format_args<buffer_context<char>>, locale_ref);

}  // namespace detail
FMT_END_NAMESPACE
