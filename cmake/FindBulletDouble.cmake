# Bullet's collision and dynamics in double precision: the target Bullet::Double. Debian's libbullet-dev names these
# libraries with the suffix -float64; a build of one's own with -DUSE_DOUBLE_PRECISION=ON has none, and is not taken unless
# BulletDouble_SUFFIX is set to an empty string.
set(BulletDouble_SUFFIX "-float64" CACHE STRING "Suffix of the libraries of Bullet in double precision")
find_path(BulletDouble_INCLUDE_DIR btBulletDynamicsCommon.h PATH_SUFFIXES bullet)
foreach(library BulletDynamics BulletCollision LinearMath)
  find_library(BulletDouble_${library} ${library}${BulletDouble_SUFFIX})
  mark_as_advanced(BulletDouble_${library})
endforeach()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(BulletDouble
  REQUIRED_VARS BulletDouble_BulletDynamics BulletDouble_BulletCollision BulletDouble_LinearMath BulletDouble_INCLUDE_DIR
  REASON_FAILURE_MESSAGE "Debian: apt-get install libbullet-dev")
mark_as_advanced(BulletDouble_INCLUDE_DIR BulletDouble_SUFFIX)

if(BulletDouble_FOUND AND NOT TARGET Bullet::Double)
  add_library(Bullet::Double INTERFACE IMPORTED)
  set_target_properties(Bullet::Double PROPERTIES
    INTERFACE_INCLUDE_DIRECTORIES "${BulletDouble_INCLUDE_DIR}"
    INTERFACE_COMPILE_DEFINITIONS BT_USE_DOUBLE_PRECISION
    INTERFACE_LINK_LIBRARIES "${BulletDouble_BulletDynamics};${BulletDouble_BulletCollision};${BulletDouble_LinearMath}")
endif()
