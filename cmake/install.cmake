# `cmake --install`: libraries with their headers, the executables, the configs, and the package that find_package(Repose)
# finds. Targets: Repose::core, Repose::backends, Repose::analysis. Headers are included as inside the project:
# #include "core/scene.hpp".
include(CMakePackageConfigHelpers)

set(REPOSE_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/Repose)
foreach(library repose_options repose_dvi_options repose_core repose_dvi_collision repose_dvi repose_bullet
        repose_dart repose_backends repose_analysis repose_bundle repose_diagnosis repose_render repose_report)
  if(TARGET ${library})
    list(APPEND REPOSE_LIBRARIES ${library})
  endif()
endforeach()

foreach(library IN LISTS REPOSE_LIBRARIES)
  string(REPLACE repose_ "" short_name ${library})
  set_target_properties(${library} PROPERTIES EXPORT_NAME ${short_name})
  add_library(Repose::${short_name} ALIAS ${library})
endforeach()
install(TARGETS ${REPOSE_LIBRARIES} EXPORT ReposeTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(EXPORT ReposeTargets NAMESPACE Repose:: DESTINATION ${REPOSE_PACKAGE_DIR})

foreach(folder core backends analysis)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/${folder} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/repose
          FILES_MATCHING PATTERN "*.hpp")
endforeach()
install(DIRECTORY ${PROJECT_SOURCE_DIR}/scenarios/configs ${PROJECT_SOURCE_DIR}/analysis/reference
        DESTINATION ${CMAKE_INSTALL_DATADIR}/repose)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})

set(REPOSE_HAS_DART OFF)
if(TARGET repose_dart)
  set(REPOSE_HAS_DART ON)
endif()
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/ReposeConfig.cmake.in ${PROJECT_BINARY_DIR}/ReposeConfig.cmake
                              INSTALL_DESTINATION ${REPOSE_PACKAGE_DIR})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/ReposeConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_SOURCE_DIR}/cmake/FindBulletDouble.cmake ${PROJECT_BINARY_DIR}/ReposeConfig.cmake ${PROJECT_BINARY_DIR}/ReposeConfigVersion.cmake
        DESTINATION ${REPOSE_PACKAGE_DIR})
