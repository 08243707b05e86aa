# Picture tests: the viewer is started, does what a person does, and what it shows is compared.
#
#   picture_test(NAME [SCENE ring] [SIZE 1000x600] [SAME A.png B.png ...] [DIFFERENT A.png B.png ...])
#
# plays tests/pictures/NAME.script in an empty folder, on a copy of tests/pictures/scenes/SCENE.ivory.json
# that is called scene.ivory.json there. It passes where the script does (its `expect` steps) and
#   X.window.png    equals the baseline tests/baselines/NAME.X.png within the tolerance of
#                   tests/tools/compare_pictures.cpp; a missing baseline fails;
#   X.viewport.png  equals byte for byte what `ivory render` draws of X.ivory.json beside it;
#   SAME, DIFFERENT pairs of pictures are or are not byte for byte the same.
# A failure leaves the pictures and their differences in the folder, build/.../tests/pictures/NAME.
# Baselines are those of Dear ImGui 1.86: with another version they are left out, and the test says so.
# IVORY_UPDATE_BASELINES=1 in the environment writes the baselines instead.
function(picture_test name)
    cmake_parse_arguments(PARSE_ARGV 1 test "" "SCENE;SIZE" "SAME;DIFFERENT")
    if(NOT test_SCENE)
        set(test_SCENE ring)
    endif()
    if(NOT test_SIZE)
        set(test_SIZE 1000x600)
    endif()
    add_test(
        NAME picture.${name}
        COMMAND ${CMAKE_COMMAND}
            -D name=${name}
            -D scene=${PROJECT_SOURCE_DIR}/tests/pictures/scenes/${test_SCENE}.ivory.json
            -D size=${test_SIZE}
            "-D same=${test_SAME}"
            "-D different=${test_DIFFERENT}"
            -D ivory=$<TARGET_FILE:ivory>
            -D compare=$<TARGET_FILE:compare_pictures>
            -D imgui=${imgui_VERSION}
            -D source=${PROJECT_SOURCE_DIR}/tests
            -D folder=${CMAKE_CURRENT_BINARY_DIR}/pictures/${name}
            -P ${PROJECT_SOURCE_DIR}/tests/pictures/run_picture_test.cmake)
    set_tests_properties(picture.${name} PROPERTIES
        LABELS gui
        TIMEOUT ${time_limit}
        SKIP_REGULAR_EXPRESSION "SKIPPED: "
        ENVIRONMENT "${gui_environment}")
endfunction()
