#include "framing.h"

void pel_bitio_read(pel_bitio_t *io, const uint8_t *p, size_t n_bytes)
{
    io->writing = false;
    pel_bit_reader_init(&io->r, p, n_bytes);
}

void pel_bitio_write(pel_bitio_t *io, uint8_t *p, size_t n_bytes)
{
    io->writing = true;
    pel_bit_writer_init(&io->w, p, n_bytes);
}

bool pel_bitio_failed(const pel_bitio_t *io)
{
    return io->writing ? (io->w.overrun || io->w.out_of_range) : io->r.overrun;
}

void pel_io_u(pel_bitio_t *io, unsigned n_bits, uint32_t *v)
{
    if (io->writing) {
        pel_write_u(&io->w, n_bits, *v);
    } else {
        *v = (uint32_t)pel_read_u(&io->r, n_bits);
    }
}

void pel_io_fill(pel_bitio_t *io, unsigned n_bits, uint64_t v)
{
    if (io->writing) {
        pel_write_u(&io->w, n_bits, v);
    } else {
        pel_skip_bits(&io->r, n_bits);
    }
}

void pel_io_signed(pel_bitio_t *io, unsigned n_bits, double unit, double *v)
{
    if (io->writing) {
        pel_write_s(&io->w, n_bits, pel_round_i64(*v / unit));
    } else {
        *v = (double)pel_read_s(&io->r, n_bits) * unit;
    }
}

/* ---- little-endian ---------------------------------------------------------------------------------------------------- */

void pel_leio_read(pel_leio_t *io, const uint8_t *p, size_t n)
{
    io->out = NULL;
    io->in = p;
    io->cap = n;
    io->n = 0;
    io->failed = false;
}

void pel_leio_write(pel_leio_t *io, uint8_t *p, size_t cap)
{
    io->out = p;
    io->in = NULL;
    io->cap = cap;
    io->n = 0;
    io->failed = false;
}

/* The low n_bytes of v out, or as many in. */
static uint64_t le_io(pel_leio_t *io, unsigned n_bytes, uint64_t v)
{
    if (io->failed || n_bytes > io->cap - io->n) {
        io->failed = true;
        return v;
    }
    const size_t at = io->n;
    io->n += n_bytes;
    if (io->out != NULL) {
        pel_le_put(io->out + at, n_bytes, v);
        return v;
    }
    return pel_le_u(io->in + at, n_bytes);
}

void pel_le_io_u8(pel_leio_t *io, uint8_t *v)
{
    *v = (uint8_t)le_io(io, 1, *v);
}

void pel_le_io_u16(pel_leio_t *io, uint16_t *v)
{
    *v = (uint16_t)le_io(io, 2, *v);
}

void pel_le_io_u32(pel_leio_t *io, uint32_t *v)
{
    *v = (uint32_t)le_io(io, 4, *v);
}

void pel_le_io_i32(pel_leio_t *io, int32_t *v)
{
    *v = (int32_t)(uint32_t)le_io(io, 4, (uint64_t)(int64_t)*v);
}

void pel_le_io_i64(pel_leio_t *io, int64_t *v)
{
    *v = (int64_t)le_io(io, 8, (uint64_t)*v);
}

void pel_le_io_f32(pel_leio_t *io, float *v, int n)
{
    for (int i = 0; i < n; i++) {
        uint8_t b[4];
        pel_le_put_f32(b, v[i]);
        pel_le_put(b, 4, le_io(io, 4, pel_le_u(b, 4)));
        v[i] = pel_le_f32(b);
    }
}

void pel_le_io_f64(pel_leio_t *io, double *v, int n)
{
    for (int i = 0; i < n; i++) {
        uint8_t b[8];
        pel_le_put_f64(b, v[i]);
        pel_le_put(b, 8, le_io(io, 8, pel_le_u(b, 8)));
        v[i] = pel_le_f64(b);
    }
}
