/* tint_tracker.c - a tracker in C that looks at colour: its points never move, and its features are what colours say.
 *
 *   cc -std=c99 -shared -fPIC -fvisibility=hidden -Iinclude examples/tint_tracker.c -o honami-tint.so
 *
 * It shows how fields are read that a host of ABI 1.0 does not know. null_tracker.c is the complete tracker.
 */
#include "honami.h"
#include <stdlib.h>
#include <string.h>

#define MANIFEST                                                                                                   \
  "{\"honami\":1,\"abi\":[1,1],"                                                                                   \
  "\"library\":{\"id\":\"org.honami.examples.tint\",\"version\":\"1.1.0\",\"license\":\"MIT OR Apache-2.0\"},"     \
  "\"plugins\":[{\"id\":\"org.honami.tint\",\"kind\":\"tracker\",\"name\":\"Tint\",\"doc\":\"score = Cb, Cr\","    \
  "\"interfaces\":[\"honami.tracker/1\",\"honami.detect/1\"],"                                                     \
  "\"caps\":{\"latency\":0,\"deterministic\":true,\"parallel_instances\":true,\"pixels\":[\"gray8\"]},"            \
  "\"params\":[]}]}"
HONAMI_MANIFEST(MANIFEST);

static void destroy(honami_instance *instance) { free(instance); }

static honami_code set_params(honami_instance *instance, const honami_call *call, const honami_value *values, uint32_t n) {
  (void)instance, (void)call, (void)values, (void)n;
  return HONAMI_OK;
}

static honami_code begin(honami_instance *instance, const honami_call *call, const honami_stream_info *stream) {
  (void)instance, (void)call, (void)stream;
  return HONAMI_OK;
}

static honami_code seed(honami_instance *instance, const honami_call *call, const honami_table *table) {
  (void)instance, (void)table;
  return call->fail(call, HONAMI_E_UNSUPPORTED, "it follows no points, it only detects");
}

static honami_code retire(honami_instance *instance, const honami_call *call, const uint32_t *ids, uint64_t n) {
  (void)instance, (void)call, (void)ids, (void)n;
  return HONAMI_OK;
}

static honami_code push(honami_instance *instance, const honami_call *call, const honami_frame *frame) {
  (void)instance, (void)call, (void)frame;
  return HONAMI_OK;
}

static honami_code end(honami_instance *instance, const honami_call *call) {
  (void)instance, (void)call;
  return HONAMI_OK;
}

/* One feature in the last pixel: its score is Cb and Cr in one number, -1 for a clip without colour, -2 for a host that
 * knows none. */
static honami_code detect(honami_instance *instance, const honami_call *call, const honami_detect_input *input) {
  const honami_frame *frame = input->frame;
  honami_column out[3] = {{"x", HONAMI_F32, 1, NULL, 0}, {"y", HONAMI_F32, 1, NULL, 0}, {"score", HONAMI_F32, 1, NULL, 0}};
  uint32_t x = frame->width - 1, y = frame->height - 1;
  float score = -2;
  honami_code code;
  (void)instance;
  if (HONAMI_HAS(frame, honami_frame, chroma_height)) {
    score = -1;
    if (frame->cb && frame->cr) {
      uint64_t i = (uint64_t)x * frame->chroma_width / frame->width, j = (uint64_t)y * frame->chroma_height / frame->height;
      int64_t at = (int64_t)j * frame->chroma_stride + (int64_t)i;
      score = (float)(1000 * frame->cb[at] + frame->cr[at]);
    }
  }
  code = call->reserve(call, HONAMI_FEATURES, 1, 3, out);
  if (code < 0) return code;
  *(float *)out[0].data = (float)x;
  *(float *)out[1].data = (float)y;
  *(float *)out[2].data = score;
  return call->commit(call, HONAMI_FEATURES, 1);
}

static const honami_tracker_v1 tracker = {HONAMI_SIZE_TO(honami_tracker_v1, end), 0, begin, seed, retire, push, end};
static const honami_detect_v1 detector = {HONAMI_SIZE_TO(honami_detect_v1, detect), 0, detect};

static const void *get_interface(honami_instance *instance, const char *id) {
  (void)instance;
  if (strcmp(id, HONAMI_DETECT) == 0) return &detector;
  return strcmp(id, HONAMI_TRACKER) == 0 ? &tracker : NULL;
}

static honami_instance *create(const honami_host_info *host, const honami_call *call, const char *plugin_id) {
  honami_instance *made;
  (void)host;
  if (strcmp(plugin_id, "org.honami.tint") != 0) {
    call->fail(call, HONAMI_E_UNSUPPORTED, "no such plugin");
    return NULL;
  }
  made = (honami_instance *)calloc(1, sizeof(honami_instance));
  if (!made) return NULL;
  made->struct_size = HONAMI_SIZE_TO(honami_instance, get_interface);
  made->destroy = destroy;
  made->set_params = set_params;
  made->get_interface = get_interface;
  return made;
}

const honami_library *honami_library_v1(const honami_host_info *host) {
  static const honami_library library = {HONAMI_SIZE_TO(honami_library, create), HONAMI_ABI_MINOR, honami_note.text,
                                         sizeof(MANIFEST) - 1, create};
  (void)host;
  return &library;
}
