# cmake --install build/release --prefix DIR [--component server|client]: the programs, and what the server looks for
# beside itself (../share/brume).
install(TARGETS brume-server COMPONENT server)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/server/scenes DESTINATION share/brume COMPONENT server)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/client/web/dist/ DESTINATION share/brume/web COMPONENT server)
install(TARGETS brume-client COMPONENT client)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/NOTICE DESTINATION share/doc/brume COMPONENT server)
