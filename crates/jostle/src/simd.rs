//! The widest vector instructions of the machine, chosen while the program runs.
//!
//! The kernels are plain loops. Compiled once more with AVX2 allowed, the compiler
//! puts eight float32 into each of their operations instead of four. No operation is
//! fused or reordered, so both give the same bits. This is the only module with
//! unsafe code: calling what the processor might not understand.
#![allow(unsafe_code)]

/// Runs `work`, compiled with AVX2 where the processor has it. Whatever `work` calls
/// takes part only as far as it is inlined into it.
#[inline]
pub fn widest<R>(work: impl FnOnce() -> R) -> R {
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("bmi1") {
        // SAFETY: the processor has just said that it has both features.
        return unsafe { with_avx2(work) };
    }
    work()
}

/// # Safety
///
/// The processor must have AVX2 and BMI1.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,bmi1")]
unsafe fn with_avx2<R>(work: impl FnOnce() -> R) -> R {
    work()
}
