//! Memory that a call frees is kept by the allocator.
//!
//! glibc returns large blocks to the system and gets them again zeroed, page by page. At a million
//! shapes this takes up to half of the time, but not the same for all libraries. A program that
//! does the same work in every frame would not do so.
#![allow(unsafe_code)]

/// Sets the allocator to keep freed memory, for all libraries.
pub fn keep() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    // SAFETY: sets options of the allocator, before a second thread exists.
    unsafe {
        // The largest threshold; one arena, because those of threads are returned entirely.
        libc::mallopt(libc::M_MMAP_THRESHOLD, 32 << 20);
        libc::mallopt(libc::M_TRIM_THRESHOLD, i32::MAX);
        libc::mallopt(libc::M_ARENA_MAX, 1);
    }
}
