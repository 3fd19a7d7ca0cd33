# The flags of the builds that look for faults while they run: sanitizers, fuzzers.
if(THIMBLE_SANITIZE OR THIMBLE_SANITIZE_THREADS OR THIMBLE_FUZZ)
  # Frames in light by the map, one template for ten sets of effects: optimised they take a third of the build.
  set(THIMBLE_SETS_OPTIONS -O0)
endif()
if(THIMBLE_SANITIZE)
  # Without what AddressSanitizer finds by itself (a null pointer, an object that is too small) it compiles in three quarters
  # of the time.
  add_compile_options(-fsanitize=address,undefined -fno-sanitize=null,object-size,vptr,nonnull-attribute,returns-nonnull-attribute
    -fno-sanitize-recover=all -fno-omit-frame-pointer -O1)
  add_link_options(-fsanitize=address,undefined)
  # The tests start the command thousands of times; without relocations it starts faster. The words for each check
  # are 26 MB, looked through for leaks at every end: without, a fault is an illegal instruction (handle_sigill=1).
  add_compile_options(-fno-pie $<$<NOT:$<BOOL:${THIMBLE_SANITIZE_WORDS}>>:-fsanitize-undefined-trap-on-error>)
  add_link_options(-no-pie)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    add_compile_options(-Wno-maybe-uninitialized)  # gcc sees ghosts through the instrumentation
  else()
    add_compile_definitions(__SANITIZE_ADDRESS__=1)  # as gcc does; the tests choose their counts by it
  endif()
  # Code that is long to compile and short to run: what parses command lines, and the test cases themselves.
  set(THIMBLE_FRONT_OPTIONS -O0)
endif()
if(THIMBLE_SANITIZE_THREADS)
  add_compile_options(-fsanitize=thread -fno-omit-frame-pointer -O1)
  add_link_options(-fsanitize=thread)
  # oneTBB is not compiled with it, so every hand-over in there would look like a race. The tests choose their counts
  # by AddressSanitizer's macro.
  add_compile_definitions(THIMBLE_STD_THREADS __SANITIZE_ADDRESS__=1)
  set(THIMBLE_FRONT_OPTIONS -O0)
  # What draws or sorts in several threads; the rest takes as long to compile and finds nothing. The simulator's own
  # thread has a board's stack, on which ThreadSanitizer has no room.
  set(THIMBLE_TESTED "(wide/test_|viewer/test_pictures|tree/test_key_sort|picture/test_panel|platform/test_band_crew)")
endif()
if(THIMBLE_FUZZ)
  add_compile_options(-fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=all
    -fno-omit-frame-pointer -O1)
  add_link_options(-fsanitize=address,undefined)
endif()
