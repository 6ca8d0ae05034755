# cmake --install build/release --prefix DIR [--component server|client]: the programs, what the server looks for beside
# itself (../share/brume), units for systemd, pages of the manual.
include(GNUInstallDirs)
set(CMAKE_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
install(TARGETS brume-server COMPONENT server)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/server/scenes DESTINATION share/brume COMPONENT server)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/client/web/dist/ DESTINATION share/brume/web COMPONENT server
        PATTERN .brume-stamp EXCLUDE)
install(FILES ${PROJECT_SOURCE_DIR}/deploy/systemd/brume.service ${PROJECT_SOURCE_DIR}/deploy/systemd/brume@.service
        DESTINATION lib/systemd/system COMPONENT server)
foreach(unit brume brume@)
  install(FILES ${PROJECT_SOURCE_DIR}/deploy/systemd/limits.conf DESTINATION lib/systemd/system/${unit}.service.d
          COMPONENT server)
endforeach()
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/NOTICE DESTINATION share/doc/brume COMPONENT server)
install(TARGETS brume-client brume-load COMPONENT client)

# brume_compressed(RESULT FILE): FILE as Debian wants it, compressed without a time. A change of it configures anew.
find_program(GZIP gzip REQUIRED)
function(brume_compressed result file)
  get_filename_component(name ${file} NAME)
  set(copy ${PROJECT_BINARY_DIR}/package/${name})
  configure_file(${PROJECT_SOURCE_DIR}/${file} ${copy} @ONLY)
  execute_process(COMMAND ${GZIP} -9nfk ${copy} COMMAND_ERROR_IS_FATAL ANY)
  set(${result} ${copy}.gz PARENT_SCOPE)
endfunction()
brume_compressed(manual deploy/debian/brume-server.1)
install(FILES ${manual} DESTINATION share/man/man1 COMPONENT server)
foreach(program client load)
  brume_compressed(manual deploy/debian/brume-${program}.1)
  install(FILES ${manual} DESTINATION share/man/man1 COMPONENT client)
endforeach()
