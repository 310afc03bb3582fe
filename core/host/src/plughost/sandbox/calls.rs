//! The calls that are refused (seccomp): a list of what is allowed would break with every new libc.

use super::Programs;
use seccompiler::{
    BpfProgram, SeccompAction, SeccompCmpArgLen, SeccompCmpOp, SeccompCondition, SeccompFilter, SeccompRule,
    TargetArch, apply_filter, sock_filter,
};
use std::collections::BTreeMap;

/// Calls that a plugin has no business with.
const REFUSED: [libc::c_long; 21] = [
    // What it starts is to end with it.
    libc::SYS_setsid,
    libc::SYS_setpgid,
    libc::SYS_pidfd_getfd,
    // Local ones, too: what listens there does so for people.
    libc::SYS_socket,
    libc::SYS_execve,
    libc::SYS_execveat,
    libc::SYS_ptrace,
    libc::SYS_process_vm_readv,
    libc::SYS_process_vm_writev,
    libc::SYS_bpf,
    libc::SYS_perf_event_open,
    libc::SYS_io_uring_setup,
    libc::SYS_userfaultfd,
    libc::SYS_mount,
    libc::SYS_umount2,
    libc::SYS_pivot_root,
    libc::SYS_unshare,
    libc::SYS_setns,
    libc::SYS_keyctl,
    libc::SYS_add_key,
    libc::SYS_request_key,
];

/// A new world, in which it would have rights that it has not here.
const WORLDS: [libc::c_int; 7] = [
    libc::CLONE_NEWUSER,
    libc::CLONE_NEWNS,
    libc::CLONE_NEWPID,
    libc::CLONE_NEWNET,
    libc::CLONE_NEWIPC,
    libc::CLONE_NEWUTS,
    libc::CLONE_NEWCGROUP,
];

/// The kernel's calls once more under other numbers begin here (x32).
const OTHER_NUMBERS: u32 = 0x4000_0000;

/// Whether there are filters for this processor.
pub(super) fn is_known_here() -> bool {
    TargetArch::try_from(std::env::consts::ARCH).is_ok()
}

/// Refuses them from now on, to this thread and those it starts.
pub(super) fn refuse(programs: &Programs) -> Result<(), Box<dyn std::error::Error>> {
    let mut rules: BTreeMap<i64, Vec<SeccompRule>> = REFUSED.iter().map(|call| (*call, Vec::new())).collect();
    if *programs != Programs::Refused {
        rules.remove(&libc::SYS_execve);
    }
    let bits = |argument, mask: libc::c_int, value: libc::c_int| {
        let (mask, value) = (u64::from(mask.unsigned_abs()), u64::from(value.unsigned_abs()));
        let condition =
            SeccompCondition::new(argument, SeccompCmpArgLen::Dword, SeccompCmpOp::MaskedEq(mask), value);
        SeccompRule::new(vec![condition?])
    };
    let worlds = WORLDS.iter().map(|world| bits(0, *world, *world));
    rules.insert(libc::SYS_clone, worlds.collect::<Result<_, _>>()?);
    // Datagrams go anywhere, also from one of a pair, and what the kernel does not know it may take for them: only
    // streams (1) and sequences of packets (5) are left.
    let other_kinds = [(1, 0), (2, 2), (8, 8)].map(|(mask, value)| bits(1, mask, value));
    rules.insert(libc::SYS_socketpair, other_kinds.into_iter().collect::<Result<_, _>>()?);
    rules.extend(signals(programs)?);
    let another = SeccompCondition::new(0, SeccompCmpArgLen::Dword, SeccompCmpOp::Ne, 0)?;
    rules.insert(libc::SYS_prlimit64, vec![SeccompRule::new(vec![another])?]);
    let refused = SeccompAction::Errno(libc::EPERM.unsigned_abs());
    let filter =
        SeccompFilter::new(rules, SeccompAction::Allow, refused, std::env::consts::ARCH.try_into()?)?;
    apply_filter(&BpfProgram::try_from(filter)?)?;
    apply_filter(&by_number())?;
    Ok(())
}

/// Signals to others, on a kernel whose landlock does not keep them in: a library has none to send, a program may end
/// what it has started but not everybody. Its own group is what ends with it.
fn signals(programs: &Programs) -> Result<Vec<(i64, Vec<SeccompRule>)>, seccompiler::BackendError> {
    let is = |op, value| SeccompCondition::new(0, SeccompCmpArgLen::Dword, op, value);
    if *programs != Programs::Refused {
        let everybody = is(SeccompCmpOp::Eq, u64::from(u32::MAX))?;
        return Ok(vec![(libc::SYS_kill, vec![SeccompRule::new(vec![everybody])?])]);
    }
    let another = || is(SeccompCmpOp::Ne, std::process::id().into());
    let mut rules = vec![
        (libc::SYS_kill, vec![SeccompRule::new(vec![another()?, is(SeccompCmpOp::Ne, 0)?])?]),
        (libc::SYS_tkill, Vec::new()),
        (libc::SYS_pidfd_send_signal, Vec::new()),
    ];
    for call in [libc::SYS_tgkill, libc::SYS_rt_sigqueueinfo, libc::SYS_rt_tgsigqueueinfo] {
        rules.push((call, vec![SeccompRule::new(vec![another()?])?]));
    }
    Ok(rules)
}

/// What the library for filters cannot say: a range of numbers, and that a call is not known here. `clone3` has its
/// arguments where no filter sees them; a libc that is told so takes `clone`.
fn by_number() -> BpfProgram {
    let step = |code: u32, [jt, jf]: [u8; 2], k: u32| sock_filter { code: code as u16, jt, jf, k };
    let jump_if = |condition| libc::BPF_JMP | libc::BPF_K | condition;
    let end = |with| step(libc::BPF_RET | libc::BPF_K, [0, 0], with);
    let error = |number: libc::c_int| end(libc::SECCOMP_RET_ERRNO | number.unsigned_abs());
    vec![
        step(libc::BPF_LD | libc::BPF_W | libc::BPF_ABS, [0, 0], 0),
        step(jump_if(libc::BPF_JGE), [2, 0], OTHER_NUMBERS),
        step(jump_if(libc::BPF_JEQ), [2, 0], libc::SYS_clone3 as u32),
        end(libc::SECCOMP_RET_ALLOW),
        error(libc::EPERM),
        error(libc::ENOSYS),
    ]
}
