# Every library that Rimlight uses, found once here; folders link the targets that they need.
# System headers come in as SYSTEM includes, so that our warnings stay ours.

find_package(PkgConfig REQUIRED)
find_package(Threads REQUIRED)
find_package(Boost 1.81 REQUIRED)
find_package(CLI11 REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(GTest REQUIRED)
find_package(OpenSSL 3 REQUIRED COMPONENTS Crypto SSL)
find_package(PNG REQUIRED)
find_package(TBB REQUIRED)
find_package(assimp 5.2 REQUIRED)
find_package(benchmark REQUIRED)
find_package(embree 3.13 REQUIRED)
find_package(hwy 1.0.3 REQUIRED)
find_package(libjpeg-turbo REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(spdlog REQUIRED)
pkg_check_modules(jwt REQUIRED IMPORTED_TARGET libjwt)
pkg_check_modules(openexr REQUIRED IMPORTED_TARGET OpenEXR)
pkg_check_modules(sqlite3 REQUIRED IMPORTED_TARGET sqlite3>=3.37)  # STRICT tables
pkg_check_modules(stb REQUIRED IMPORTED_TARGET stb)
pkg_check_modules(xxhash REQUIRED IMPORTED_TARGET libxxhash)

include(GoogleTest)
