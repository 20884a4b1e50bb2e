# Target `tidy`: clang-tidy over every source of the product, a library or program at a time, as nearly all of its work is
# on the headers that their files share. It looks again when one of the sources, or any header, has changed.
set(STILLCUT_TIDY_MORE "" CACHE STRING "Further checks, e.g. clang-analyzer-* (slow)")
find_program(CLANG_TIDY clang-tidy)
if(CLANG_TIDY)
  set(rooms dsp models rt drivers adapters tools)
  list(TRANSFORM rooms REPLACE ".+" "${PROJECT_SOURCE_DIR}/\\0/*.hpp")
  file(GLOB_RECURSE headers CONFIGURE_DEPENDS ${rooms})
  set(folder ${PROJECT_BINARY_DIR}/tidy)
  set(stamps)
  foreach(target stillcut_dds stillcut-dds stillcut_adapters stillcut_tools stillcut_commands stillcut_models stillcut_model_types stillcut_files stillcut_can stillcut_lcm stillcut_rt stillcut_dsp stillcut stillcutd)
    get_target_property(sources ${target} SOURCES)
    get_target_property(libraries ${target} LINK_LIBRARIES)
    list(TRANSFORM sources REPLACE ".+" "#include \"\\0\"  // NOLINT(bugprone-suspicious-include)\n" OUTPUT_VARIABLE includes)
    list(JOIN includes "" includes)
    file(CONFIGURE OUTPUT ${folder}/${target}.cpp CONTENT "${includes}")
    # Never built: it tells clang-tidy, through the compilation database, how the sources are compiled.
    add_library(tidy_${target} OBJECT EXCLUDE_FROM_ALL ${folder}/${target}.cpp)
    target_include_directories(tidy_${target} PRIVATE ${PROJECT_SOURCE_DIR})
    target_compile_definitions(tidy_${target} PRIVATE $<TARGET_PROPERTY:${target},COMPILE_DEFINITIONS>)
    target_link_libraries(tidy_${target} PRIVATE ${libraries})
    add_custom_command(OUTPUT ${folder}/${target}.ok
      COMMAND ${CLANG_TIDY} --quiet --config-file=${PROJECT_SOURCE_DIR}/.clang-tidy --checks=${STILLCUT_TIDY_MORE}
        -p ${PROJECT_BINARY_DIR} ${folder}/${target}.cpp
      COMMAND ${CMAKE_COMMAND} -E touch ${folder}/${target}.ok
      DEPENDS ${folder}/${target}.cpp ${sources} ${headers} ${PROJECT_SOURCE_DIR}/.clang-tidy stillcut_lcm_types stillcut_dds_types
      COMMENT "clang-tidy ${target}")
    list(APPEND stamps ${folder}/${target}.ok)
  endforeach()
  add_custom_target(tidy DEPENDS ${stamps})
endif()
