# Copies the public headers (PublicHeaders.txt) from `source` and `generated` to `target`.
# `tools/scene` becomes `scene`, and `tools/library/supple.h` stands above all.
file(STRINGS "${source}/cmake/PublicHeaders.txt" headers ENCODING UTF-8 REGEX "^[^#]")
foreach(header IN LISTS headers)
  set(from "${source}/${header}")
  if(NOT EXISTS "${from}")
    set(from "${generated}/${header}")
  endif()
  file(READ "${from}" text)
  string(REGEX REPLACE "^tools/(library/)?" "" to "${header}")
  string(REGEX REPLACE "#include \"(tools/)?((volumes|lib|raycast|scene)/[^\"]+)\""
                       "#include <supple/\\2>" text "${text}")
  file(WRITE "${target}/${to}" "${text}")
endforeach()
