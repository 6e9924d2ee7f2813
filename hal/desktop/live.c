/* live.c - captures as they happen: the channels of a live LCM (lcm-logplayer, pelorus-sim --live). */
#include <lcm/lcm.h>
#include <stdlib.h>
#include <string.h>

#include "desktop.h"

#define QUEUE 4096 /* events received and not yet served */

typedef struct {
    int64_t t_us;
    char channel[64];
    uint8_t *data;
    size_t n;
} queued_t;

struct desktop_live_t {
    lcm_t *lcm;
    lcm_subscription_t *subscription;
    queued_t queue[QUEUE];
    size_t head, count;
    queued_t current;
};

static void keep(const lcm_recv_buf_t *buf, const char *channel, void *user)
{
    desktop_live_t *live = user;
    if (live->count == QUEUE) { return; }
    queued_t *q = &live->queue[(live->head + live->count) % QUEUE];
    q->data = malloc(buf->data_size);
    if (q->data == NULL) { return; }
    memcpy(q->data, buf->data, buf->data_size);
    q->n = buf->data_size;
    q->t_us = buf->recv_utime;
    strncpy(q->channel, channel, sizeof q->channel - 1);
    q->channel[sizeof q->channel - 1] = '\0';
    live->count++;
}

desktop_live_t *desktop_live_open(const char *url)
{
    desktop_live_t *live = calloc(1, sizeof *live);
    if (live == NULL) { return NULL; }
    live->lcm = lcm_create(url);
    if (live->lcm == NULL) {
        free(live);
        return NULL;
    }
    return live;
}

bool desktop_live_next(desktop_live_t *live, capture_event_t *event, int timeout_ms)
{
    if (live->subscription == NULL) {
        live->subscription = lcm_subscribe(live->lcm, "(UART_(IMU|ROVER|BASE|AUX1)|TRUTH|SETUP)", keep, live);
        lcm_subscription_set_queue_capacity(live->subscription, QUEUE);
    }
    while (live->count == 0) {
        if (lcm_handle_timeout(live->lcm, timeout_ms) <= 0) { return false; }
    }
    free(live->current.data);
    live->current = live->queue[live->head];
    live->head = (live->head + 1) % QUEUE;
    live->count--;
    *event = (capture_event_t){live->current.t_us, live->current.channel, live->current.data, live->current.n};
    return true;
}

bool desktop_live_publish(desktop_live_t *live, const char *channel, const void *data, size_t n)
{
    return lcm_publish(live->lcm, channel, data, (unsigned)n) == 0;
}

void desktop_live_close(desktop_live_t *live)
{
    lcm_destroy(live->lcm);
    while (live->count > 0) {
        free(live->queue[live->head].data);
        live->head = (live->head + 1) % QUEUE;
        live->count--;
    }
    free(live->current.data);
    free(live);
}
