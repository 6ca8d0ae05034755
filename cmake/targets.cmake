# Flags that every target of ours has, and the two kinds of target: a library per folder, a program.
add_library(brume_flags INTERFACE)
target_include_directories(brume_flags INTERFACE ${PROJECT_SOURCE_DIR})
# No contraction: the simulation gives the same bits whatever the compiler. Vulkan's structs are written as
# {VK_STRUCTURE_TYPE_...} with the rest zero, which Clang's -Wextra would take for a mistake.
target_compile_options(brume_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Werror -Wno-missing-field-initializers
                                             -ffp-contract=off)
target_compile_definitions(brume_flags INTERFACE BRUME_VERSION="${PROJECT_VERSION}")
if(BRUME_SANITIZE) # GCC warns without cause about instrumented code (its manual advises against -Werror here): release is the judge
  target_compile_options(brume_flags INTERFACE -fsanitize=${BRUME_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer
                                               -Wno-error)
  target_link_options(brume_flags INTERFACE -fsanitize=${BRUME_SANITIZE})
endif()

# brume_library(NAME SOURCES ... LINKS ...)
function(brume_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINKS" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  target_link_libraries(${name} PUBLIC brume_flags ${ARG_LINKS})
endfunction()

# brume_program(NAME SOURCES ... LINKS ...)
function(brume_program name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINKS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE brume_flags ${ARG_LINKS})
endfunction()

# brume_test(NAME LABEL unit|gpu|hard|net SOURCES ... LINKS ...): one ctest entry per program, so that a device is made once.
# The target tests-LABEL builds all programs of one label.
function(brume_test name)
  cmake_parse_arguments(ARG "" "LABEL;TIMEOUT" "SOURCES;LINKS" ${ARGN})
  brume_program(${name} SOURCES ${ARG_SOURCES} LINKS ${ARG_LINKS} GTest::gtest GTest::gtest_main)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  if(NOT TARGET tests-${ARG_LABEL})
    add_custom_target(tests-${ARG_LABEL})
  endif()
  add_dependencies(tests-${ARG_LABEL} ${name})
  add_test(NAME ${name} COMMAND ${name} WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
  endif()
  set_tests_properties(${name} PROPERTIES LABELS ${ARG_LABEL} TIMEOUT ${ARG_TIMEOUT})
endfunction()
