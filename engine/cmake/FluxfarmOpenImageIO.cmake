# fluxfarm::openimageio. By pkg-config: Debian 12's CMake file names an include folder of OpenCV that its package does not bring.
find_package(PkgConfig REQUIRED)
pkg_check_modules(FLUXFARM_OPENIMAGEIO REQUIRED IMPORTED_TARGET OpenImageIO>=2.4)
add_library(fluxfarm_openimageio INTERFACE)
target_link_libraries(fluxfarm_openimageio INTERFACE PkgConfig::FLUXFARM_OPENIMAGEIO)
add_library(fluxfarm::openimageio ALIAS fluxfarm_openimageio)
