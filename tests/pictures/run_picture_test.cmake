# One picture test: see pictures.cmake.
set(baselines_of 1.86)

file(REMOVE_RECURSE ${folder})
file(MAKE_DIRECTORY ${folder})
file(COPY_FILE ${scene} ${folder}/scene.ivory.json)

execute_process(
    COMMAND ${ivory} scene.ivory.json --headless --size ${size} --threads 2
        --script ${source}/pictures/${name}.script
    WORKING_DIRECTORY ${folder}
    RESULT_VARIABLE result
    ERROR_VARIABLE message)
if(message MATCHES "needs OpenGL in memory" AND "$ENV{IVORY_REQUIRE_OPENGL}" STREQUAL "")
    message("SKIPPED: ${message}")
    return()
endif()
if(NOT result EQUAL 0)
    message(FATAL_ERROR "ivory ended with ${result}: ${message}")
endif()

set(failures "")
set(compared 0)

# compare(EXPECTED ACTUAL [--exact]): adds to `failures`.
macro(compare expected actual)
    execute_process(
        COMMAND ${compare} ${expected} ${actual} ${ARGN} --difference ${actual}.difference.png
        WORKING_DIRECTORY ${folder}
        RESULT_VARIABLE result
        ERROR_VARIABLE message)
    if(NOT result EQUAL 0)
        string(APPEND failures "  ${message}")
    endif()
    math(EXPR compared "${compared} + 1")
endmacro()

file(GLOB windows RELATIVE ${folder} ${folder}/*.window.png)
foreach(picture IN LISTS windows)
    string(REPLACE ".window.png" "" part ${picture})
    set(baseline ${source}/baselines/${name}.${part}.png)
    if(NOT imgui VERSION_EQUAL baselines_of)
        message("Dear ImGui is ${imgui}: ${picture} is not compared with the baseline, which is of ${baselines_of}")
    elseif(DEFINED ENV{IVORY_UPDATE_BASELINES})
        file(COPY_FILE ${folder}/${picture} ${baseline})
    elseif(NOT EXISTS ${baseline})
        string(APPEND failures "  there is no baseline ${baseline} for ${folder}/${picture}\n")
    else()
        compare(${baseline} ${picture})
    endif()
endforeach()

file(GLOB viewports RELATIVE ${folder} ${folder}/*.viewport.png)
foreach(picture IN LISTS viewports)
    string(REPLACE ".viewport.png" "" part ${picture})
    if(NOT EXISTS ${folder}/${part}.ivory.json)
        continue()
    endif()
    execute_process(COMMAND ${compare} --size ${picture} WORKING_DIRECTORY ${folder}
        OUTPUT_VARIABLE picture_size OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
    execute_process(
        COMMAND ${ivory} render ${part}.ivory.json -o ${part}.render.png --size ${picture_size} --quiet
        WORKING_DIRECTORY ${folder} COMMAND_ERROR_IS_FATAL ANY)
    compare(${part}.render.png ${picture} --exact)
endforeach()

while(same)
    list(POP_FRONT same first second)
    compare(${first} ${second} --exact)
endwhile()

while(different)
    list(POP_FRONT different first second)
    execute_process(COMMAND ${compare} ${first} ${second} --exact WORKING_DIRECTORY ${folder}
        RESULT_VARIABLE result ERROR_QUIET)
    if(NOT result EQUAL 1)
        string(APPEND failures "  ${first} and ${second} are the same\n")
    endif()
    math(EXPR compared "${compared} + 1")
endwhile()

if(failures)
    message(FATAL_ERROR "in ${folder}:\n${failures}")
endif()
message("${compared} pictures compared")
