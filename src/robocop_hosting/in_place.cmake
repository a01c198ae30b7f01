# Included after project() in the top CMakeLists.txt of a workspace whose packages are links: each is built by the path
# to which its link leads, which messages then name, unless make, CMake or genmsg may not take a character of it.
macro(add_subdirectory folder)
  get_filename_component(linked_folder "${CMAKE_CURRENT_SOURCE_DIR}/${folder}" REALPATH)
  if(${ARGC} EQUAL 1 AND CMAKE_CURRENT_SOURCE_DIR STREQUAL CMAKE_SOURCE_DIR
     AND linked_folder MATCHES "^[A-Za-z0-9/._-]+$")
    _add_subdirectory("${linked_folder}" "${folder}")
  else()
    _add_subdirectory(${ARGV})
  endif()
endmacro()
