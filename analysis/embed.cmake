# repose_embed(TARGET NAME FILE): puts the bytes of FILE into the library TARGET; in C++ they are
#   namespace repose::embedded { std::string_view NAME(); }
# The assembler copies the file (.incbin), so that a large file costs no compile time.
function(repose_embed target name file)
  set(source ${CMAKE_CURRENT_BINARY_DIR}/embedded_${name}.cpp)
  file(CONFIGURE OUTPUT ${source} @ONLY CONTENT [=[
#include <string_view>
__asm__(
    ".pushsection .rodata\n.balign 16\n"
    ".hidden repose_embedded_@name@\n.global repose_embedded_@name@\n"
    ".hidden repose_embedded_@name@_end\n.global repose_embedded_@name@_end\n"
    "repose_embedded_@name@:\n.incbin \"@file@\"\n"
    "repose_embedded_@name@_end:\n.byte 0\n.popsection\n");
extern "C" const char repose_embedded_@name@[];
extern "C" const char repose_embedded_@name@_end[];
namespace repose::embedded {
std::string_view @name@();
std::string_view @name@() { return {repose_embedded_@name@, repose_embedded_@name@_end}; }
}  // namespace repose::embedded
]=])
  set_source_files_properties(${source} PROPERTIES OBJECT_DEPENDS ${file})
  target_sources(${target} PRIVATE ${source})
endfunction()
