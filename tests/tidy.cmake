# Target `tidy`: clang-tidy over every source of the product, again only for what changed since (any header counts for all).
set(STILLCUT_TIDY_MORE "" CACHE STRING "Further checks, e.g. clang-analyzer-* (slow)")
find_program(CLANG_TIDY clang-tidy)
if(CLANG_TIDY)
  set(stamps)
  file(GLOB_RECURSE headers CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/*.hpp)
  list(FILTER headers INCLUDE REGEX "^(dsp|models|rt|drivers|tools)/")
  list(TRANSFORM headers PREPEND ${PROJECT_SOURCE_DIR}/)
  foreach(room dsp models rt drivers tools)
    file(GLOB_RECURSE sources CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/${room}/*.cpp)
    foreach(source ${sources})
      set(stamp ${PROJECT_BINARY_DIR}/tidy/${source}.ok)
      get_filename_component(folder ${stamp} DIRECTORY)
      add_custom_command(OUTPUT ${stamp}
        COMMAND ${CLANG_TIDY} --quiet --checks=${STILLCUT_TIDY_MORE} -p ${PROJECT_BINARY_DIR} ${source}
        COMMAND ${CMAKE_COMMAND} -E make_directory ${folder}
        COMMAND ${CMAKE_COMMAND} -E touch ${stamp}
        DEPENDS ${PROJECT_SOURCE_DIR}/${source} ${headers} ${PROJECT_SOURCE_DIR}/.clang-tidy stillcut_lcm_types
        WORKING_DIRECTORY ${PROJECT_SOURCE_DIR} COMMENT "clang-tidy ${source}")
      list(APPEND stamps ${stamp})
    endforeach()
  endforeach()
  add_custom_target(tidy DEPENDS ${stamps})
endif()
