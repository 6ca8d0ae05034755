# Flags that every target of ours has, and the two kinds of target: a library per folder, a program.
add_library(brume_flags INTERFACE)
target_include_directories(brume_flags INTERFACE ${PROJECT_SOURCE_DIR})
# No contraction: the simulation gives the same bits whatever the compiler. Vulkan's structs are written as
# {VK_STRUCTURE_TYPE_...} with the rest zero, which Clang's -Wextra would take for a mistake.
target_compile_options(brume_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Werror -Wno-missing-field-initializers
                                             -ffp-contract=off)
target_compile_definitions(brume_flags INTERFACE BRUME_VERSION="${PROJECT_VERSION}")
# Clang compiles instrumented code in less than half the time that GCC takes. Clang 14 cannot check the types of called
# functions (-fsanitize=function) where there are coroutines. A test's own operator new comes before the sanitizer's
# (-z muldefs). Warnings are errors in the other builds. BRUME_SANITIZED tells sources, whichever compiler it is.
if(BRUME_SANITIZE)
  target_compile_definitions(brume_flags INTERFACE BRUME_SANITIZED)
  target_compile_options(brume_flags INTERFACE -O1 -fsanitize=${BRUME_SANITIZE} -fno-sanitize-recover=all
                                               -fno-omit-frame-pointer -Wno-error
                                               $<$<CXX_COMPILER_ID:Clang>:-fno-sanitize=function>)
  target_link_options(brume_flags INTERFACE -fsanitize=${BRUME_SANITIZE} -Wl,-z,muldefs)
endif()

# Several sources of a target as one: what they include is read once, and templates are made once. That takes a third of
# the time. Names in anonymous namespaces must differ. BRUME_TOGETHER=OFF compiles each file by itself, as clang-tidy
# does.
option(BRUME_TOGETHER "Compile up to eight sources together" ON)
function(brume_compiled_together name)
  set_target_properties(${name} PROPERTIES UNITY_BUILD ${BRUME_TOGETHER} UNITY_BUILD_BATCH_SIZE 8)
  # GCC takes the one file that includes the others for a header's user.
  if(BRUME_TOGETHER AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(${name} PRIVATE -Wno-subobject-linkage)
  endif()
endfunction()

# brume_library(NAME SOURCES ... LINKS ...)
function(brume_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINKS" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  target_link_libraries(${name} PUBLIC brume_flags ${ARG_LINKS})
  brume_compiled_together(${name})
endfunction()

# brume_program(NAME SOURCES ... LINKS ...)
function(brume_program name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINKS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE brume_flags ${ARG_LINKS})
  brume_compiled_together(${name})
endfunction()

# brume_test(NAME [BY_FILE] SOURCES ... LINKS ... [TIMEOUT seconds] [ALONE FILE...]). Its label is the folder's name;
# the target tests-LABEL builds all programs of one label. ctest runs the program once, or BY_FILE: once for each of its
# sources, see tests_by_file.cmake. ALONE: files, without .cpp, that measure time: no other test runs beside them.
function(brume_test name)
  cmake_parse_arguments(ARG "BY_FILE" "TIMEOUT" "SOURCES;LINKS;ALONE" ${ARGN})
  get_filename_component(label ${CMAKE_CURRENT_SOURCE_DIR} NAME)
  brume_program(${name} SOURCES ${ARG_SOURCES} LINKS ${ARG_LINKS} GTest::gtest GTest::gtest_main)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  target_compile_options(${name} PRIVATE $<$<CONFIG:RelWithDebInfo>:-O1>) # compiling takes longer than running
  if(NOT TARGET tests-${label})
    add_custom_target(tests-${label})
  endif()
  add_dependencies(tests-${label} ${name})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
  endif()
  if(BRUME_SANITIZE)
    math(EXPR ARG_TIMEOUT "10 * ${ARG_TIMEOUT}")
  endif()
  if(ARG_BY_FILE)
    set(tests ${CMAKE_CURRENT_BINARY_DIR}/${name}_by_file.cmake)
    file(GENERATE OUTPUT ${tests} CONTENT "set(program \"$<TARGET_FILE:${name}>\")
set(name ${name})
set(label ${label})
set(folder \"${PROJECT_SOURCE_DIR}\")
set(timeout ${ARG_TIMEOUT})
set(alone ${ARG_ALONE})
include(\"${PROJECT_SOURCE_DIR}/cmake/tests_by_file.cmake\")
")
    set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${tests})
  else()
    add_test(NAME ${name} COMMAND ${name} WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
    set_tests_properties(${name} PROPERTIES LABELS ${label} TIMEOUT ${ARG_TIMEOUT})
  endif()
endfunction()

# Runs some tests of a test program (patterns of --gtest_filter) with a second implementation of Vulkan, so that nothing
# is relied on that only Mesa does. The entry is called NAME_swiftshader. That implementation keeps no shaders: only
# tests that compile fast are here. The whole layer runs all tests with it.
function(brume_test_on_swiftshader name)
  get_filename_component(label ${CMAKE_CURRENT_SOURCE_DIR} NAME)
  string(JOIN : tests ${ARGN})
  add_test(NAME ${name}_swiftshader WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
           COMMAND tests/gpu/with_swiftshader.sh $<TARGET_FILE:${name}> --gtest_filter=${tests})
  set_tests_properties(${name}_swiftshader PROPERTIES LABELS ${label} TIMEOUT 600 SKIP_RETURN_CODE 77)
endfunction()
