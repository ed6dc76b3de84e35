# Copies the public headers from `source` and `generated` to `target`. Those of plugins, of
# vectorised kernels (-inl.h) and of the thesis' reference algorithms stay behind.
# `tools/scene` becomes `scene`.
file(GLOB_RECURSE headers RELATIVE ${source}
     ${source}/volumes/*.h ${source}/lib/*.h ${source}/raycast/*.h ${source}/tools/scene/*.h)
list(FILTER headers EXCLUDE REGEX "/plugin/|-inl\\.h$|/reference/|_plugin\\.h$")
set(places)
foreach(header IN LISTS headers)
  list(APPEND places "${source}/${header}|${header}")
endforeach()
list(APPEND places "${generated}/volumes/base/version.h|volumes/base/version.h"
                   "${source}/tools/library/supple.h|supple.h")
foreach(place IN LISTS places)
  string(REGEX REPLACE "^(.*)\\|(.*)$" "\\1;\\2" pair "${place}")
  list(GET pair 0 from)
  list(GET pair 1 to)
  file(READ "${from}" text)
  string(REGEX REPLACE "^tools/" "" to "${to}")
  string(REGEX REPLACE "#include \"(tools/)?((volumes|lib|raycast|scene)/[^\"]+)\""
                       "#include <supple/\\2>" text "${text}")
  file(WRITE "${target}/${to}" "${text}")
endforeach()
