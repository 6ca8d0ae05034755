# cpack -G DEB: the packages brume-server, and brume-client with brume-load. ./dev package builds them.
# They are native ones: no revision of Debian's follows the version.
brume_compressed(changelog deploy/debian/changelog)
set(conffiles ${PROJECT_BINARY_DIR}/package/conffiles)
file(WRITE ${conffiles} "/etc/brume/brume.toml\n")
foreach(part server client)
  install(FILES ${PROJECT_SOURCE_DIR}/deploy/debian/copyright ${changelog}
          DESTINATION /usr/share/doc/brume-${part} COMPONENT package-${part})
  install(FILES ${PROJECT_SOURCE_DIR}/deploy/debian/lintian-overrides DESTINATION /usr/share/lintian/overrides
          RENAME brume-${part} COMPONENT package-${part})
endforeach()
install(FILES ${PROJECT_SOURCE_DIR}/deploy/brume.toml DESTINATION /etc/brume COMPONENT package-server)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME brume)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT "The authors of brume <brume@localhost>")
set(CPACK_STRIP_FILES ON)
set(CPACK_SET_DESTDIR ON)
set(CPACK_INSTALL_PREFIX /usr)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS ${CMAKE_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS})
set(CPACK_OUTPUT_FILE_PREFIX ${PROJECT_BINARY_DIR}/packages)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# Packages are made at every check: gzip takes half the time of xz, and 2 MB more.
set(CPACK_DEBIAN_COMPRESSION_TYPE gzip)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_SERVER_PACKAGE_NAME brume-server)
set(CPACK_DEBIAN_CLIENT_PACKAGE_NAME brume-client)
set(CPACK_DEBIAN_SERVER_PACKAGE_CONTROL_EXTRA ${conffiles})
# The driver that draws without a GPU; another one will do.
set(CPACK_DEBIAN_SERVER_PACKAGE_RECOMMENDS mesa-vulkan-drivers)
set(CPACK_DEBIAN_SERVER_PACKAGE_SUGGESTS "nats-server, haproxy, prometheus")
set(CPACK_COMPONENT_SERVER_DESCRIPTION "server that streams one shared cloud to many viewers
One soft, self-shadowed cloud is simulated and lit once per tick, 60 times
a second, and rendered for every viewer. Viewers come by a browser, a native
client or a stream of JPEG pictures.")
set(CPACK_COMPONENT_CLIENT_DESCRIPTION "viewer of a brume server's cloud, and a load generator
The native client shows the cloud in a window or writes its pictures to
files. The load generator watches a server as many viewers at once.")
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
include(CPack)
foreach(part server client)
  cpack_add_component_group(${part})
  cpack_add_component(${part} GROUP ${part})
  cpack_add_component(package-${part} GROUP ${part})
endforeach()
