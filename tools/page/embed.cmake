# Embeds files as bytes in the program, so that an installation needs no other files.
# include(tools/page/embed.cmake)
# slipbench_embed(generated NAMESPACE slipbench::cost HEADER tools/cost/explore.h FILES a.js b.css)
# sets `generated` to a C++ source that defines NAMESPACE::assets(), which HEADER declares, with the
# files in this order.
if(NOT CMAKE_SCRIPT_MODE_FILE)
  set(SLIPBENCH_EMBED_SCRIPT ${CMAKE_CURRENT_LIST_FILE} CACHE INTERNAL "")
  function(slipbench_embed variable)
    cmake_parse_arguments(ARG "" "NAMESPACE;HEADER" "FILES" ${ARGN})
    set(files "")
    foreach(file IN LISTS ARG_FILES)
      get_filename_component(path ${file} ABSOLUTE)
      list(APPEND files ${path})
    endforeach()
    set(output ${CMAKE_CURRENT_BINARY_DIR}/assets_data.cc)
    add_custom_command(OUTPUT ${output}
      COMMAND ${CMAKE_COMMAND} "-DFILES=${files}" -DOUTPUT=${output} -DHEADER=${ARG_HEADER} -DNAMESPACE=${ARG_NAMESPACE}
        -P ${SLIPBENCH_EMBED_SCRIPT}
      DEPENDS ${files} ${SLIPBENCH_EMBED_SCRIPT}
      COMMENT "Embedding the files of ${ARG_HEADER}" VERBATIM)
    # The preset `lint` builds nothing, so its unity sources must not include generated files.
    set_source_files_properties(${output} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
    set(${variable} ${output} PARENT_SCOPE)
  endfunction()
  return()
endif()

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
  "const std::vector<page::Asset>& assets() {\n  static const std::vector<page::Asset> all = {\n${entries}  };\n  return all;\n}\n\n"
  "}  // namespace ${NAMESPACE}\n")
file(WRITE ${OUTPUT} "${text}")
