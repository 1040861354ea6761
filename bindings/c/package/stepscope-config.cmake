# find_package(stepscope CONFIG): targets
#   stepscope::stepscope   the shared library, with stepscope.h and stepscope.hpp
#   stepscope::static      the same as a static library
#   stepscope::walk        stepscope_walk.h alone, for firmware with exported tables
get_filename_component(_stepscope_prefix "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)

if(NOT TARGET stepscope::stepscope)
    add_library(stepscope::stepscope SHARED IMPORTED)
    set_target_properties(stepscope::stepscope PROPERTIES
        IMPORTED_LOCATION "${_stepscope_prefix}/lib/libstepscope.so.0"
        IMPORTED_SONAME "libstepscope.so.0"
        INTERFACE_INCLUDE_DIRECTORIES "${_stepscope_prefix}/include")

    add_library(stepscope::static STATIC IMPORTED)
    set_target_properties(stepscope::static PROPERTIES
        IMPORTED_LOCATION "${_stepscope_prefix}/lib/libstepscope.a"
        INTERFACE_LINK_LIBRARIES "gcc_s;pthread;m;dl"
        INTERFACE_INCLUDE_DIRECTORIES "${_stepscope_prefix}/include")

    add_library(stepscope::walk INTERFACE IMPORTED)
    set_target_properties(stepscope::walk PROPERTIES
        INTERFACE_INCLUDE_DIRECTORIES "${_stepscope_prefix}/include")
endif()

unset(_stepscope_prefix)
