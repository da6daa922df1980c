# Robots, parameters and states from peer_cases, then each robot converted to every format by delta-model. With effects: the header, and
# what delta-validate says of a log of that robot.
cmake_minimum_required(VERSION 3.25)

file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER})
execute_process(COMMAND ${CASES} ${FOLDER} COMMAND_ERROR_IS_FATAL ANY)
foreach(type IN LISTS TYPES)
  foreach(target "mjcf:xml" "urdf:out.urdf" "header:hpp")
    string(REGEX MATCH "([^:]+):(.+)" whole ${target})
    execute_process(
      COMMAND ${TOOLS}/delta-model convert ${FOLDER}/${type}.urdf --params ${FOLDER}/${type}_params.csv --to ${CMAKE_MATCH_1}
        -o ${FOLDER}/${type}.${CMAKE_MATCH_2}
      COMMAND_ERROR_IS_FATAL ANY)
  endforeach()
endforeach()
foreach(type IN LISTS TYPES)
  if(NOT EXISTS ${FOLDER}/${type}_effects.csv)
    continue()
  endif()
  set(model ${FOLDER}/${type}.urdf --params ${FOLDER}/${type}_params.csv --effects ${FOLDER}/${type}_effects.csv)
  set(log ${FOLDER}/${type}_effects_log.csv)
  execute_process(
    COMMAND ${TOOLS}/delta-simulate ${model} --trajectory ${FOLDER}/${type}_trajectory.csv --inverse -o ${log}
    COMMAND_ERROR_IS_FATAL ANY)
  execute_process(
    COMMAND ${TOOLS}/delta-validate ${model} ${log} --no-filter -o ${FOLDER}/${type}_effects_residuals.csv
    COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND ${TOOLS}/delta-model convert ${model} --to header -o ${FOLDER}/${type}_effects.hpp COMMAND_ERROR_IS_FATAL ANY)
endforeach()
