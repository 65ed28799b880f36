# What the Debian package holds beyond the programs and the page (preset `package`, deploy/package).

set(CPACK_PACKAGE_CONTACT "Beltflow <beltflow@localhost>")
set(configuration ${CMAKE_BINARY_DIR}/beltflow.conf)
add_custom_command(OUTPUT ${configuration}
  COMMAND sh -c "$1 --sample-config >$2 && printf '\\ndata = /var/lib/beltflow\\n' >>$2"
          sh $<TARGET_FILE:beltflowd> ${configuration}
  DEPENDS beltflowd VERBATIM)

set(pages ${CMAKE_BINARY_DIR}/man)
add_custom_command(OUTPUT ${pages}
  COMMAND ${CMAKE_SOURCE_DIR}/deploy/man-pages $<TARGET_FILE_DIR:beltflowd> ${pages} ${BELTFLOW_BUILD}
  DEPENDS beltflow beltflowd ${CMAKE_SOURCE_DIR}/deploy/man-pages VERBATIM)

set(documents ${CMAKE_BINARY_DIR}/doc)
configure_file(deploy/debian/changelog.in ${documents}/changelog.Debian @ONLY)
configure_file(deploy/CHANGELOG.md ${documents}/changelog COPYONLY)
add_custom_command(OUTPUT ${documents}/changelog.gz ${documents}/changelog.Debian.gz
  COMMAND gzip -9nkf changelog changelog.Debian
  DEPENDS ${documents}/changelog ${documents}/changelog.Debian WORKING_DIRECTORY ${documents} VERBATIM)
add_custom_target(package_files ALL
  DEPENDS ${configuration} ${pages} ${documents}/changelog.gz ${documents}/changelog.Debian.gz)

install(FILES ${configuration} DESTINATION /etc/beltflow)
install(FILES deploy/systemd/beltflow.service deploy/systemd/beltflow-backup.service
  deploy/systemd/beltflow-backup.timer DESTINATION /lib/systemd/system)
install(FILES deploy/systemd/sysusers.conf DESTINATION lib/sysusers.d RENAME beltflow.conf)
install(FILES deploy/systemd/tmpfiles.conf DESTINATION lib/tmpfiles.d RENAME beltflow.conf)
install(DIRECTORY ${pages}/ DESTINATION share/man/man1 FILES_MATCHING PATTERN *.1.gz)
install(DIRECTORY ${pages}/ DESTINATION share/man/man8 FILES_MATCHING PATTERN *.8.gz)
install(FILES ${documents}/changelog.gz ${documents}/changelog.Debian.gz deploy/debian/copyright README.md
  DESTINATION share/doc/beltflow)
install(DIRECTORY api/docs/ DESTINATION share/doc/beltflow/manual)
install(DIRECTORY deploy/nginx deploy/prometheus deploy/grafana DESTINATION share/doc/beltflow/examples)
install(FILES deploy/debian/lintian-overrides DESTINATION share/lintian/overrides RENAME beltflow)

set(CPACK_GENERATOR DEB)
set(CPACK_SET_DESTDIR ON) # /etc and /lib are outside of the prefix
set(CPACK_STRIP_FILES ON)
set(CPACK_PACKAGE_NAME beltflow)
set(CPACK_PACKAGE_VERSION ${BELTFLOW_BUILD})
set(CPACK_PACKAGE_VENDOR Beltflow)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGE_DESCRIPTION
"Predicts how parts on a conveyor belt jam before a deflector and how many
 get past it. A daemon solves queued scenarios and streams density, parts and
 outflow curves as JSON, CSV and binary.")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS
  "debconf (>= 0.5) | debconf-2.0, systemd | systemd-standalone-sysusers, systemd | systemd-standalone-tmpfiles")
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
foreach(script postinst prerm postrm templates)
  list(APPEND CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${CMAKE_SOURCE_DIR}/deploy/debian/${script})
endforeach()
file(WRITE ${CMAKE_BINARY_DIR}/conffiles "/etc/beltflow/beltflow.conf\n")
list(APPEND CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${CMAKE_BINARY_DIR}/conffiles)
include(CPack)
