# How every target of the project is built: flags, one library per folder, one test binary per folder.

set(RIMLIGHT_SANITIZE "" CACHE STRING "Sanitizers for -fsanitize=, comma separated; empty for none")
option(RIMLIGHT_FUZZ "Build the libFuzzer targets of tests/fuzz (Clang only)" OFF)
option(RIMLIGHT_VP8 "Offer frames as VP8 (libvpx and libyuv); without it they are JPEG" ON)

add_library(rimlight_flags INTERFACE)
target_compile_options(rimlight_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>  # GCC 12 sees overlaps in std::string's operator+ (bug 105651)
  -ffp-contract=off)  # the same bits wherever the compiler could contract a*b+c; kernels ask for FMA
target_include_directories(rimlight_flags INTERFACE ${PROJECT_SOURCE_DIR})
if(RIMLIGHT_SANITIZE)
  # UBSan's function check needs RTTI of C callbacks, which libraries in C do not have.
  target_compile_options(rimlight_flags INTERFACE
    -fsanitize=${RIMLIGHT_SANITIZE} -fno-sanitize-recover=all)
  string(REPLACE "fuzzer-no-link," "" RIMLIGHT_LINK_SANITIZE "${RIMLIGHT_SANITIZE}")
  target_link_options(rimlight_flags INTERFACE -fsanitize=${RIMLIGHT_LINK_SANITIZE})
  if(RIMLIGHT_SANITIZE MATCHES "thread")
    target_compile_definitions(rimlight_flags INTERFACE RIMLIGHT_THREAD_SANITIZER)
  endif()
  if(RIMLIGHT_SANITIZE MATCHES "undefined")
    target_compile_options(rimlight_flags INTERFACE -fno-sanitize=function)
    target_link_options(rimlight_flags INTERFACE -fno-sanitize=function)
  endif()
endif()

# rimlight_library(name SOURCES a.cpp … HEADERS a.h … [USES public targets] [LIBRARIES private targets])
# One static library for one folder. Headers form a verified header set (each compiles alone).
function(rimlight_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;HEADERS;USES;LIBRARIES" ${ARGN})
  add_library(rimlight_${name} STATIC ${ARG_SOURCES})
  target_sources(rimlight_${name} PUBLIC
    FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR} FILES ${ARG_HEADERS})
  list(TRANSFORM ARG_USES REPLACE "^(core_.+|server|cli)$" "rimlight_\\1")
  target_link_libraries(rimlight_${name} PUBLIC rimlight_flags ${ARG_USES} PRIVATE ${ARG_LIBRARIES})
endfunction()

# What the sanitizers must know when a test runs, as an ENVIRONMENT property: libraries that are not
# built with ThreadSanitizer (Embree, OpenEXR, TBB) synchronise in ways that it does not see.
# Nothing waits a second at its end, which tests of how a program ends would see.
set(RIMLIGHT_TEST_ENVIRONMENT "")
if(RIMLIGHT_SANITIZE MATCHES "thread")
  set(RIMLIGHT_TEST_ENVIRONMENT "TSAN_OPTIONS=ignore_noninstrumented_modules=1:atexit_sleep_ms=0")
endif()

# rimlight_test(name SOURCES a_test.cpp … [LIBRARIES targets])
# One GoogleTest binary for one folder, `name`_test; each TEST is a ctest of its own.
function(rimlight_test name)
  cmake_parse_arguments(ARG "" "TIMEOUT" "SOURCES;LIBRARIES" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 240)
  endif()
  add_executable(${name}_test ${ARG_SOURCES})
  target_link_libraries(${name}_test PRIVATE ${ARG_LIBRARIES} rimlight_flags GTest::gmock GTest::gtest_main)
  gtest_discover_tests(${name}_test
    NO_PRETTY_VALUES  # parameters print as addresses, which differ from run to run
    DISCOVERY_TIMEOUT 60
    WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
    PROPERTIES TIMEOUT ${ARG_TIMEOUT} LABELS ${name} ENVIRONMENT "${RIMLIGHT_TEST_ENVIRONMENT}")
endfunction()
