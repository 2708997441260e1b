//! Memory that a call frees stays with the program.
//!
//! glibc gives large blocks back to the system and gets them again zeroed, page by page. In a
//! program that does the same work every frame that would be a mistake, and at a million
//! shapes it takes up to half of the time, from all rivals alike but not evenly.
#![allow(unsafe_code)]

/// Tells the allocator to keep what it has, for all rivals.
pub fn keep() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    // SAFETY: sets numbers of the allocator, before there is a second thread.
    unsafe {
        // The largest that is taken; one arena, because those of threads are given back whole.
        libc::mallopt(libc::M_MMAP_THRESHOLD, 32 << 20);
        libc::mallopt(libc::M_TRIM_THRESHOLD, i32::MAX);
        libc::mallopt(libc::M_ARENA_MAX, 1);
    }
}
