# Every third-party library, found once. deploy/packages.txt names the Debian packages that bring them.
find_package(PkgConfig REQUIRED)
find_package(Threads REQUIRED)
find_package(Eigen3 REQUIRED NO_MODULE)
find_package(nlohmann_json REQUIRED)
find_package(spdlog REQUIRED)
find_package(OpenSSL REQUIRED)
find_package(SQLite3 REQUIRED)
find_package(PostgreSQL REQUIRED)  # libpq
find_package(CLI11 REQUIRED)
find_package(Ceres REQUIRED)
find_package(OpenCV REQUIRED COMPONENTS core imgproc imgcodecs calib3d features2d aruco ml)
find_package(GTest REQUIRED)
# httplib: the flags come from pkg-config alone, because its feature macros change class layouts (Debian ships it split
# into a header and a library).
pkg_check_modules(HTTPLIB REQUIRED IMPORTED_TARGET cpp-httplib)
pkg_check_modules(HWY REQUIRED IMPORTED_TARGET libhwy)
pkg_check_modules(ARAVIS REQUIRED IMPORTED_TARGET aravis-0.8)
find_package(PNG REQUIRED)
find_package(TIFF REQUIRED)
pkg_check_modules(TURBOJPEG REQUIRED IMPORTED_TARGET libturbojpeg)
pkg_check_modules(PROMETHEUS REQUIRED IMPORTED_TARGET prometheus-cpp-core)
# PCL by component: find_package(PCL) would load VTK and Qt, which nothing here uses.
pkg_check_modules(PCL_SURFACE REQUIRED IMPORTED_TARGET pcl_surface pcl_common)
pkg_check_modules(PCL_SEGMENTATION REQUIRED IMPORTED_TARGET pcl_segmentation pcl_search pcl_filters pcl_kdtree pcl_common)
