# Robots, parameters and states from peer_cases, then each robot converted to every format by delta-model.
cmake_minimum_required(VERSION 3.25)

file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER})
execute_process(COMMAND ${CASES} ${FOLDER} COMMAND_ERROR_IS_FATAL ANY)
foreach(type IN LISTS TYPES)
  foreach(target "mjcf:xml" "urdf:out.urdf" "header:hpp")
    string(REGEX MATCH "([^:]+):(.+)" whole ${target})
    execute_process(
      COMMAND ${MODEL} convert ${FOLDER}/${type}.urdf --params ${FOLDER}/${type}_params.csv --to ${CMAKE_MATCH_1}
        -o ${FOLDER}/${type}.${CMAKE_MATCH_2}
      COMMAND_ERROR_IS_FATAL ANY)
  endforeach()
endforeach()
