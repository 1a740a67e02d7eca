# Run after a test program is linked:
#   cmake -D PROGRAM=... -D NAME=world -D MOST=12 -D LABELS=... -D TIMEOUT=... -D OUTPUT=... -P list_suites.cmake
# Writes one ctest test for every suite of the program, or for every MOST tests of a longer one. A test for each case
# would start the program each time, and with MRPT's libraries that takes longer than most cases do.
execute_process(COMMAND ${PROGRAM} --gtest_list_tests OUTPUT_VARIABLE listed RESULT_VARIABLE result)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "${PROGRAM} --gtest_list_tests: found exit code ${result}, expected 0")
endif()

# For builds with sanitizers; no others read it.
set(environment "LSAN_OPTIONS=suppressions=${CMAKE_CURRENT_LIST_DIR}/../tests/leaks.supp:print_suppressions=0")
set(text "")
set(suite "")
set(cases "")
set(chunk 0)
macro(end_chunk)
  if(cases)
    list(JOIN cases ":" filter)
    set(test "${NAME}.${suite}")
    if(chunk GREATER 0)
      string(APPEND test ".${chunk}")
    endif()
    string(APPEND text "add_test([==[${test}]==] [==[${PROGRAM}]==] [==[--gtest_filter=${filter}]==])\n"
                       "set_tests_properties([==[${test}]==] PROPERTIES TIMEOUT ${TIMEOUT} LABELS [==[${LABELS}]==] ENVIRONMENT [==[${environment}]==])\n")
    math(EXPR chunk "${chunk} + 1")
    set(cases "")
  endif()
endmacro()

string(REPLACE ";" " " listed "${listed}")  # values of parameters
string(REPLACE "\n" ";" lines "${listed}")
foreach(line IN LISTS lines)
  string(REGEX REPLACE " *#.*" "" word "${line}")
  if(line MATCHES "^  ")
    string(STRIP "${word}" word)
    list(APPEND cases "${suite}.${word}")
    list(LENGTH cases count)
    if(NOT count LESS MOST)
      end_chunk()
    endif()
  elseif(word MATCHES "^(.*)\\.$")
    end_chunk()
    set(suite "${CMAKE_MATCH_1}")
    set(chunk 0)
  endif()
endforeach()
end_chunk()
file(WRITE ${OUTPUT} "${text}")
