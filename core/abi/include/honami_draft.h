/* honami_draft.h - structure builders and simulators: drafts, not part of ABI 1.0.
 *
 * They move to honami.h, with these ids, when an issue has used them. Until then a layout that changes changes the
 * number in its id, so that an old plugin is refused rather than misread. Rules and words are those of honami.h.
 * Space: metres, z up, right-handed. Angles in radians, time in seconds.
 */
#ifndef HONAMI_DRAFT_H
#define HONAMI_DRAFT_H

#include "honami.h"

#ifdef __cplusplus
extern "C" {
#endif

/* parent i32, x f32, y f32, z f32, radius f32, track i32; a row a node. The parent's row comes before its own
 * (-1: the root, row 0 and no other), so cycles cannot be written. track: row of the tracks it was grown from, or -1. */
#define HONAMI_SKELETON "honami.skeleton/1"
/* time_s f64, wind f32 x 3 (m/s); ascending. */
#define HONAMI_WIND "honami.wind/1"
/* d f32 x 3: displacement from rest of every node of every instance, (instance, node) row-major, no ids:
 * n_instances * n_nodes rows. */
#define HONAMI_MOTION "honami.motion/1"

/* What a structure builder may draw on. */
typedef struct honami_structure_input {
  uint32_t struct_size;
  uint32_t max_threads;
  uint64_t seed;
  const honami_table *tracks;      /* honami.tracks/1 */
  const honami_table *times;       /* honami.times/1 */
  const honami_table *dendrogram;  /* honami.dendrogram/1 over the tracks, or NULL */
} honami_structure_input;

/* Grows a skeleton from grouped tracks; every plugin of kind "structure" has it. */
#define HONAMI_STRUCTURE "honami.structure/1"
typedef struct honami_structure_v1 {
  uint32_t struct_size;
  uint32_t reserved;
  /* Commits honami.skeleton/1.  [control & idle] */
  honami_code (*run)(honami_instance *instance, const honami_call *call, const honami_structure_input *input);
} honami_structure_v1;

/* What a simulator moves. */
typedef struct honami_simulator_input {
  uint32_t struct_size;
  uint32_t max_threads;
  uint64_t seed;
  const honami_table *skeleton;  /* honami.skeleton/1, at rest */
  uint32_t n_instances;          /* copies, each in a state of its own */
  uint32_t reserved;
} honami_simulator_input;

/* Moves instances of a plant in the wind; every plugin of kind "simulator" has it. */
#define HONAMI_SIMULATOR "honami.simulator/1"
typedef struct honami_simulator_v1 {
  uint32_t struct_size;
  uint32_t reserved;
  /* Takes the plant, at rest at time 0, and forgets an earlier one.  [control] */
  honami_code (*prepare)(honami_instance *instance, const honami_call *call, const honami_simulator_input *input);
  /* Back to rest at time 0.  [control & run] */
  honami_code (*reset)(honami_instance *instance, const honami_call *call);
  /* Goes n_steps steps of dt seconds and commits the last one as honami.motion/1. wind: honami.wind/1 that covers the
   * steps, or NULL for still air. step(n) equals n times step(1).  [control & run] */
  honami_code (*step)(honami_instance *instance, const honami_call *call, double dt, uint32_t n_steps,
                      const honami_table *wind);
} honami_simulator_v1;

#ifdef __cplusplus
}
#endif
#endif
