//! What memory there is.

use std::fs::read_to_string;

/// Where a container's limit, what it has taken and its cache stand, in control groups of version 2 and 1 (bytes).
const GROUP_FILES: [[&str; 4]; 2] = [
    ["/sys/fs/cgroup", "memory.max", "memory.current", "inactive_file "],
    ["/sys/fs/cgroup/memory", "memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file "],
];

/// Memory that this process can get without swapping (bytes): the least that the system, the container and the limit of the
/// process's addresses leave; `None` where none of them says so.
pub(crate) fn free_memory() -> Option<usize> {
    let in_system = kilobytes("/proc/meminfo", "MemAvailable:");
    [in_system, free_in_group(), free_addresses()].into_iter().flatten().min()
}

/// The number after the first of a file's lines that begin so; `None` where a word stands there, such as "unlimited".
fn number(path: &str, begin: &str) -> Option<usize> {
    let text = read_to_string(path).ok()?;
    let rest = text.lines().find_map(|line| line.strip_prefix(begin))?;
    rest.split_whitespace().next()?.parse().ok()
}

fn kilobytes(path: &str, begin: &str) -> Option<usize> {
    number(path, begin)?.checked_mul(1024)
}

fn free_in_group() -> Option<usize> {
    GROUP_FILES.into_iter().find_map(|[folder, most, taken, cache]| {
        let [most, taken] = [most, taken].map(|file| number(&format!("{folder}/{file}"), ""));
        // A cache of files that nobody uses is given back.
        let cache = number(&format!("{folder}/memory.stat"), cache).unwrap_or(0);
        Some(most?.saturating_sub(taken?.saturating_sub(cache)))
    })
}

/// What `ulimit -v` leaves.
fn free_addresses() -> Option<usize> {
    let most = number("/proc/self/limits", "Max address space")?;
    Some(most.saturating_sub(kilobytes("/proc/self/status", "VmSize:")?))
}
