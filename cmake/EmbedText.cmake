# supple_embed_text(PATH CONSTANT NAMESPACE)
# A program or template becomes a constant of a header, generated/<folder>/PATH with .h for its extension.
function(supple_embed_text path constant namespace)
  set(file ${CMAKE_CURRENT_SOURCE_DIR}/${path})
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
  file(READ ${file} text)
  string(REGEX REPLACE "[.][a-z]+$" ".h" header "${path}")
  file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/generated/${folder}/${header} @ONLY CONTENT
"// @path@ as it was built in.
#pragma once

namespace @namespace@ {

constexpr const char* @constant@ = R\"text(@text@)text\";

}  // namespace @namespace@
")
endfunction()
