# cmake -DFILES="a.js;b.css" -DOUTPUT=assets_data.cc -DHEADER=tools/program/report/assets.h -DNAMESPACE=slipbench::report -P embed.cmake
# Turns files into a C++ source that defines NAMESPACE::assets(), which HEADER declares, so that the installed program needs no files beside it.
set(text "#include \"${HEADER}\"\n\nnamespace ${NAMESPACE} {\n\nnamespace {\n\n")
set(entries "")
set(index 0)
foreach(file IN LISTS FILES)
  file(READ ${file} bytes HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
  string(REPEAT "." 160 line)  # 32 bytes of "0x00,"
  string(REGEX REPLACE "(${line})" "\\1\n" bytes "${bytes}")
  get_filename_component(name ${file} NAME)
  string(APPEND text "constexpr unsigned char file_${index}[] = {\n${bytes}0x00};\n\n")
  string(APPEND entries "      {\"${name}\", text_of(file_${index}, sizeof(file_${index}) - 1)},\n")
  math(EXPR index "${index} + 1")
endforeach()
string(APPEND text "std::string_view text_of(const unsigned char* bytes, std::size_t size) {\n"
  "  return {reinterpret_cast<const char*>(bytes), size};\n}\n\n}  // namespace\n\n"
  "const std::vector<report::Asset>& assets() {\n  static const std::vector<report::Asset> all = {\n${entries}  };\n  return all;\n}\n\n"
  "}  // namespace ${NAMESPACE}\n")
file(WRITE ${OUTPUT} "${text}")
