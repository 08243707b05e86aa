# Installs Ivory from `build` into a fresh folder, builds the consumer beside this file with nothing but
# find_package, and runs both. Variables: build, work, generator, compiler, flags, build_type, version.
file(REMOVE_RECURSE ${work})

execute_process(
    COMMAND ${CMAKE_COMMAND} --install ${build} --config ${build_type} --prefix ${work}/prefix
    COMMAND_ERROR_IS_FATAL ANY)
execute_process(
    COMMAND ${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR} -B ${work}/consumer -G ${generator}
        -D CMAKE_PREFIX_PATH=${work}/prefix
        -D CMAKE_CXX_COMPILER=${compiler}
        -D CMAKE_CXX_FLAGS=${flags}
        -D CMAKE_BUILD_TYPE=${build_type}
        -D IVORY_WANTED=${version}
    COMMAND_ERROR_IS_FATAL ANY)
execute_process(
    COMMAND ${CMAKE_COMMAND} --build ${work}/consumer --config ${build_type}
    COMMAND_ERROR_IS_FATAL ANY)
execute_process(
    COMMAND ${work}/consumer/consumer
    COMMAND_ERROR_IS_FATAL ANY)
