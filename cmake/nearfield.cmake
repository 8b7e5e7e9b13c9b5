# The project's CMake functions. A folder's CMakeLists.txt is a list of files and links, nothing else.

# Every target's compiler settings. x86-64-v3 (AVX2, FMA; any PC since 2015) is the baseline; Highway dispatches
# above it at run time. Contraction is off so that a formula gives the same bits wherever it is inlined.
add_library(nearfield_settings INTERFACE)
target_compile_features(nearfield_settings INTERFACE cxx_std_20)
target_include_directories(nearfield_settings INTERFACE ${PROJECT_SOURCE_DIR})
target_compile_options(nearfield_settings INTERFACE
    -march=x86-64-v3 -ffp-contract=off -fopenmp-simd -Wall -Wextra -Wshadow -Wconversion -Wpedantic
    $<$<BOOL:${NEARFIELD_WERROR}>:-Werror>
    $<$<BOOL:${NEARFIELD_SANITIZE}>:-fsanitize=address,undefined -fno-sanitize-recover=undefined
                                    -fno-omit-frame-pointer>)
target_link_options(nearfield_settings INTERFACE
    $<$<BOOL:${NEARFIELD_SANITIZE}>:-fsanitize=address,undefined>)

# Heavy headers (CLI11, JSON, TBB) are read a few times instead of once a file: half the time of a build from scratch.
# Off in the dev preset, where files are edited and checked one by one.
function(nearfield_unity target)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ${NEARFIELD_UNITY} UNITY_BUILD_BATCH_SIZE 12)
endfunction()

# nearfield_library(NAME fit SOURCES a.h a.cpp PUBLIC targets... PRIVATE targets...)
function(nearfield_library)
    cmake_parse_arguments(ARG "" "NAME" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
    set(target nearfield_${ARG_NAME})
    add_library(${target} STATIC ${ARG_SOURCES})
    add_library(nearfield::${ARG_NAME} ALIAS ${target})
    nearfield_unity(${target})
    target_link_libraries(${target} PUBLIC nearfield_settings ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE})
endfunction()

# What runs under sanitizers: all tests labelled unit or fuzz. Building no more halves that build.
add_custom_target(unit_and_fuzz_tests)

# nearfield_test(NAME files_test SOURCES a_test.cpp LIBS targets... LABELS unit)
# One executable a folder, one CTest test a case. Sample data and shared inputs are found by environment-free,
# compiled-in source paths; what a test writes goes to its working directory.
function(nearfield_test)
    cmake_parse_arguments(ARG "" "NAME" "SOURCES;LIBS;LABELS" ${ARGN})
    add_executable(${ARG_NAME} ${ARG_SOURCES})
    target_link_libraries(${ARG_NAME} PRIVATE nearfield_settings ${ARG_LIBS} GTest::gtest GTest::gtest_main)
    target_compile_definitions(${ARG_NAME} PRIVATE
        NEARFIELD_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
    include(GoogleTest)
    if(ARG_LABELS MATCHES "unit|fuzz")
        add_dependencies(unit_and_fuzz_tests ${ARG_NAME})
    endif()
    file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/test_output/${ARG_NAME})
    gtest_discover_tests(${ARG_NAME}
        WORKING_DIRECTORY ${PROJECT_BINARY_DIR}/test_output/${ARG_NAME}
        DISCOVERY_MODE PRE_TEST
        # Tests of one executable write to the same folder: never two at once.
        PROPERTIES LABELS "${ARG_LABELS}" TIMEOUT 2400 RESOURCE_LOCK ${ARG_NAME})
endfunction()

# nearfield_shaders(render_gpu FILES render/shaders/a.comp formats/shared/b.glsl.h): puts the sources, under their paths
# from the project's root, into the library: render/gpu/shader_sources.h gives them back.
function(nearfield_shaders name)
    cmake_parse_arguments(ARG "" "" "FILES" ${ARGN})
    set(output ${CMAKE_CURRENT_BINARY_DIR}/shader_sources.cpp)
    list(TRANSFORM ARG_FILES PREPEND ${PROJECT_SOURCE_DIR}/ OUTPUT_VARIABLE inputs)
    add_custom_command(OUTPUT ${output}
        COMMAND ${CMAKE_COMMAND} -DROOT=${PROJECT_SOURCE_DIR} "-DFILES=${ARG_FILES}" -DOUTPUT=${output}
                -P ${PROJECT_SOURCE_DIR}/cmake/embed_shaders.cmake
        DEPENDS ${inputs} ${PROJECT_SOURCE_DIR}/cmake/embed_shaders.cmake
        VERBATIM)
    target_sources(nearfield_${name} PRIVATE ${output})
endfunction()
