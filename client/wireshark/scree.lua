-- Wireshark dissector of the Scree map protocol, version 1 (docs/protocol.md). MIT licence.
--
-- Copy it into Wireshark's personal Lua plugins folder (Help, About, Folders), or: tshark -X lua_script:scree.lua
-- It takes UDP datagrams that begin with SCRE, on any port. The CRC is checked; a MAC is shown but, without the key,
-- not checked.

local scree = Proto("scree", "Scree map protocol")
local bits = bit32 or bit

local TYPES = {
  [1] = "ANNOUNCE", [2] = "TILE", [3] = "MANIFEST", [4] = "HEARTBEAT", [5] = "POSE", [6] = "SUBSCRIBE", [7] = "COOKIE",
  [8] = "NACK", [9] = "PING", [10] = "PONG", [11] = "BYE", [12] = "reserved (FEC)", [13] = "POSE_INPUT",
}
local LAYERS = {
  [0] = "COST", "ELEVATION", "DIMENSION", "ELEVATION_SIGMA", "CELL_AGE", "HITS", "SLOPE", "STEP", "AMPLITUDE",
  "DIMENSION_SIGMA", "CELL_STATE",
}
local ORIGINS = {[0] = "LIVE", "REPLAY", "SIM", "HIL"}
local ENCODINGS = {[0] = "u8", "i16", "u16", "constant", "run-length"}
local SENSOR_STATES = {[0] = "no frame yet", "ok", "stale", "lost"}
local REASONS = {[0] = "the recording is at its end", "stopped by the operator", "an error", "restart"}
local CRC = {[0] = "bad", [1] = "good"}

local f = scree.fields

-- A field of the tree; `name` is its filter behind "scree.".
local function field(kind, name, label, ...)
  f[name] = ProtoField[kind]("scree." .. name, label, ...)
end

field("string", "magic", "Magic")
field("uint8", "ver_major", "Major version")
field("uint8", "ver_minor", "Minor version")
field("uint8", "type", "Type", base.DEC, TYPES)
field("uint8", "flags", "Flags", base.HEX)
field("bool", "flags.mac", "MAC trailer", 8, nil, 0x01)
field("bool", "flags.refresh", "Refresh copy", 8, nil, 0x02)
field("bool", "flags.repeat", "Repeat copy", 8, nil, 0x04)
field("bool", "flags.clock_locked", "Sender's clock is disciplined", 8, nil, 0x08)
field("uint8", "flags.origin", "Origin", base.DEC, ORIGINS, 0x30)
field("uint16", "header_len", "Header length")
field("uint16", "total_len", "Total length")
field("uint32", "stream_id", "Stream")
field("uint64", "boot_id", "Boot", base.HEX)
field("uint64", "seq", "Sequence number")
field("int64", "t_data_ns", "Time of the newest sample (Unix, ns)")
field("uint32", "age_us", "Age (us)")
field("uint32", "map_rev", "Map revision")
field("uint16", "health", "Health", base.HEX)
local HEALTH = {
  {0x0001, "sensor_stale", "Sensor stale"}, {0x0002, "sensor_lost", "Sensor lost"}, {0x0004, "pose_stale", "Pose stale"},
  {0x0008, "overload", "Overload"}, {0x0010, "calibration_missing", "Calibration missing"},
  {0x0020, "clock_stepped", "Clock stepped"}, {0x0040, "reduced_resolution", "Reduced resolution"},
  {0x0080, "recording_failed", "Recording failed"}, {0x8000, "fault", "FAULT: do not drive"},
}
for _, bit_of in ipairs(HEALTH) do field("bool", "health." .. bit_of[2], bit_of[3], 16, nil, bit_of[1]) end
field("uint16", "cost_profile", "Cost profile")
field("uint32", "config_hash", "Configuration hash", base.HEX)
field("uint16", "key_id", "Key")
field("uint32", "crc", "CRC-32", base.HEX)
field("uint8", "crc.status", "CRC status", base.DEC, CRC)
field("bytes", "mac", "MAC (not checked)")
field("bytes", "surplus", "Surplus of a later minor version")
field("uint8", "layer", "Layer", base.DEC, LAYERS)
field("int32", "tx", "Tile column")
field("int32", "ty", "Tile row")
field("int32", "tx_max", "Last tile column")
field("int32", "ty_max", "Last tile row")
field("uint32", "tile_rev", "Tile revision")
field("uint8", "tile_log2", "Tile log2")
field("uint8", "encoding", "Encoding", base.DEC, ENCODINGS)
field("uint8", "row0", "First row")
field("uint8", "rows", "Rows")
field("uint16", "known_cells", "Known cells")
field("float", "scale", "Scale")
field("float", "offset", "Offset")
field("uint32", "block_age_ms", "Block age (ms)")
field("bytes", "cells", "Cells")
field("uint64", "map_id", "Map")
field("double", "resolution_m", "Resolution (m)")
field("double", "latitude_deg", "Latitude (deg)")
field("double", "longitude_deg", "Longitude (deg)")
field("double", "altitude_m", "Altitude (m)")
field("double", "heading_rad", "Heading (rad)")
field("int32", "x_min_cells", "First cell column")
field("int32", "y_min_cells", "First cell row")
field("uint32", "columns", "Columns")
field("uint32", "rows_of_window", "Rows of the window")
field("uint32", "stale_ms", "Stale after (ms)")
field("uint32", "lost_ms", "Lost after (ms)")
field("uint32", "cell_max_age_ms", "Largest age of a cell (ms)")
field("uint32", "refresh_ms", "Refresh (ms)")
field("uint32", "heartbeat_ms", "Heartbeat (ms)")
field("uint8", "layers", "Layers")
field("stringz", "frame_name", "Frame")
field("stringz", "node_name", "Node")
field("stringz", "software_version", "Software")
field("uint16", "manifest_columns", "Columns")
field("uint16", "manifest_rows", "Rows")
field("uint64", "uptime_ms", "Uptime (ms)")
field("uint64", "frames_in", "Frames in")
field("uint64", "frames_dropped", "Frames dropped")
field("uint64", "rss_bytes", "Resident memory (bytes)")
field("uint32", "latency_p50_us", "Latency p50 (us)")
field("uint32", "latency_p99_us", "Latency p99 (us)")
field("uint32", "latency_max_us", "Latency max (us)")
field("uint32", "tiles_known", "Tiles known")
field("uint8", "sensors", "Sensors")
field("uint8", "sensor", "Sensor")
field("uint8", "sensor_state", "State", base.DEC, SENSOR_STATES)
field("uint32", "sensor_age_ms", "Age of its last frame (ms)")
field("uint8", "reason", "Reason", base.DEC, REASONS)
field("int64", "t_ns", "Time (Unix, ns)")
for _, name in ipairs({"x", "y", "z", "qx", "qy", "qz", "qw"}) do field("double", "pose." .. name, name) end
field("float", "variance", "Variance")
field("uint32", "pose_age_us", "Age of the pose (us)")
field("uint64", "cookie", "Cookie", base.HEX)
field("uint64", "layer_mask", "Layers", base.HEX)
field("uint32", "datagrams_per_s", "Datagrams/s at most")
field("uint8", "repeats", "Repeats")
field("uint32", "lease_ms", "Lease (ms)")
field("uint8", "tiles", "Tiles")
field("uint64", "nonce", "Nonce", base.HEX)
field("int64", "t_request_ns", "Request left (Unix, ns)")
field("int64", "t_receive_ns", "Request arrived (Unix, ns)")
field("int64", "t_answer_ns", "Answer left (Unix, ns)")

local bad_crc = ProtoExpert.new("scree.crc.bad", "CRC-32 is wrong", expert.group.CHECKSUM, expert.severity.ERROR)
local bad_length = ProtoExpert.new("scree.length.bad", "Length is wrong", expert.group.MALFORMED, expert.severity.ERROR)
local fault = ProtoExpert.new("scree.fault", "FAULT: do not drive", expert.group.RESPONSE_CODE, expert.severity.WARN)
scree.experts = {bad_crc, bad_length, fault}

local crc_table = {}
for i = 0, 255 do
  local c = i
  for _ = 1, 8 do
    if c % 2 == 1 then c = bits.bxor(0xEDB88320, bits.rshift(c, 1)) else c = bits.rshift(c, 1) end
  end
  crc_table[i] = c
end

-- zlib's CRC-32 of the first `length` bytes, the CRC's own four taken as zero.
local function crc32(buffer, length)
  local raw = buffer:raw(0, length)
  local crc = 0xFFFFFFFF
  for i = 1, length do
    local byte = (i > 60 and i <= 64) and 0 or raw:byte(i)
    crc = bits.bxor(crc_table[bits.band(bits.bxor(crc, byte), 0xFF)], bits.rshift(crc, 8))
  end
  return bits.bxor(crc, 0xFFFFFFFF) % 0x100000000
end

-- Adds little-endian fields one after the other: {name, bytes}; a number alone skips so many bytes. Says where it ended.
local function add_fields(tree, buffer, at, list)
  for _, item in ipairs(list) do
    if type(item) == "number" then
      at = at + item
    else
      if at + item[2] > buffer:len() then return nil end
      tree:add_le(f[item[1]], buffer(at, item[2]))
      at = at + item[2]
    end
  end
  return at
end

local POSE = {{"t_ns", 8}, {"pose.x", 8}, {"pose.y", 8}, {"pose.z", 8}, {"pose.qx", 8}, {"pose.qy", 8}, {"pose.qz", 8},
              {"pose.qw", 8}, {"variance", 4}, {"variance", 4}, {"variance", 4}, {"variance", 4}, {"variance", 4}, {"variance", 4}}

local function layer_name(number)
  return LAYERS[number] or ("layer " .. number)
end

-- Each takes tree, body (a Tvb range) and says how many bytes it knew, nil for too few, and a text for the info column.
local bodies = {}

bodies[1] = function(tree, body)
  local at = add_fields(tree, body, 0, {
    {"map_id", 8}, {"resolution_m", 8}, {"latitude_deg", 8}, {"longitude_deg", 8}, {"altitude_m", 8}, {"heading_rad", 8},
    {"tx", 4}, {"ty", 4}, {"tx_max", 4}, {"ty_max", 4}, {"x_min_cells", 4}, {"y_min_cells", 4}, {"columns", 4},
    {"rows_of_window", 4}, {"stale_ms", 4}, {"lost_ms", 4}, {"cell_max_age_ms", 4}, {"refresh_ms", 4}, {"heartbeat_ms", 4},
    {"tile_log2", 1}, {"layers", 1}, 2, {"frame_name", 32}, {"node_name", 32}, {"software_version", 32}})
  if at == nil then return nil end
  for _ = 1, body(101, 1):uint() do
    if at + 12 > body:len() then return nil end
    local layer = tree:add(body(at, 12), "Layer " .. layer_name(body(at, 1):uint()))
    at = add_fields(layer, body, at, {{"layer", 1}, {"encoding", 1}, 2, {"scale", 4}, {"offset", 4}})
  end
  return at, string.format("%d x %d cells", body(72, 4):le_uint(), body(76, 4):le_uint())
end

bodies[2] = function(tree, body)
  local at = add_fields(tree, body, 0, {
    {"tx", 4}, {"ty", 4}, {"tile_rev", 4}, {"layer", 1}, {"encoding", 1}, {"tile_log2", 1}, {"row0", 1}, {"rows", 1}, 1,
    {"known_cells", 2}, {"scale", 4}, {"offset", 4}, {"block_age_ms", 4}})
  if at == nil or at == body:len() then return nil end
  tree:add(f.cells, body(at))
  return body:len(), string.format("%s (%d, %d) rev %d", layer_name(body(12, 1):uint()), body(0, 4):le_int(),
                                   body(4, 4):le_int(), body(8, 4):le_uint())
end

bodies[3] = function(tree, body)
  local at = add_fields(tree, body, 0, {{"tx", 4}, {"ty", 4}, {"manifest_columns", 2}, {"manifest_rows", 2}, {"layer", 1},
                                        {"tile_log2", 1}, 2})
  if at == nil or at > body:len() then return nil end
  local columns, rows = body(8, 2):le_uint(), body(10, 2):le_uint()
  for _ = 1, columns * rows do
    at = add_fields(tree, body, at, {{"tile_rev", 4}})
    if at == nil then return nil end
  end
  return at, string.format("%s %d x %d tiles", layer_name(body(12, 1):uint()), columns, rows)
end

bodies[4] = function(tree, body)
  local at = add_fields(tree, body, 0, {
    {"uptime_ms", 8}, {"frames_in", 8}, {"frames_dropped", 8}, {"rss_bytes", 8}, {"latency_p50_us", 4}, {"latency_p99_us", 4},
    {"latency_max_us", 4}, {"tiles_known", 4}, {"sensors", 1}, 7})
  if at == nil or at > body:len() then return nil end
  for _ = 1, body(48, 1):uint() do
    if at + 8 > body:len() then return nil end
    local sensor = tree:add(body(at, 8), "Sensor " .. body(at, 1):uint())
    at = add_fields(sensor, body, at, {{"sensor", 1}, {"sensor_state", 1}, 2, {"sensor_age_ms", 4}})
  end
  return at, "frames " .. tostring(body(8, 8):le_uint64())
end

bodies[5] = function(tree, body)
  local at = add_fields(tree, body, 0, POSE)
  at = at and add_fields(tree, body, at, {{"pose_age_us", 4}, 4})
  return at, string.format("(%.2f, %.2f, %.2f)", body(8, 8):le_float(), body(16, 8):le_float(), body(24, 8):le_float())
end

bodies[6] = function(tree, body)
  local at = add_fields(tree, body, 0, {{"cookie", 8}, {"layer_mask", 8}, {"tx", 4}, {"ty", 4}, {"tx_max", 4}, {"ty_max", 4},
                                        {"datagrams_per_s", 4}, {"repeats", 1}, 3})
  return at, "layers 0x" .. body(8, 8):le_uint64():tohex()
end

bodies[7] = function(tree, body)
  return add_fields(tree, body, 0, {{"cookie", 8}, {"lease_ms", 4}, 4}), ""
end

bodies[8] = function(tree, body)
  local at = add_fields(tree, body, 0, {{"cookie", 8}, {"layer", 1}, {"tiles", 1}, 6})
  if at == nil or at > body:len() then return nil end
  for _ = 1, body(9, 1):uint() do
    at = add_fields(tree, body, at, {{"tx", 4}, {"ty", 4}})
    if at == nil then return nil end
  end
  return at, string.format("%s %d tiles", layer_name(body(8, 1):uint()), body(9, 1):uint())
end

bodies[9] = function(tree, body)
  return add_fields(tree, body, 0, {{"nonce", 8}, {"t_request_ns", 8}, {"t_receive_ns", 8}, {"t_answer_ns", 8}}), ""
end
bodies[10] = bodies[9]

bodies[11] = function(tree, body)
  return add_fields(tree, body, 0, {{"reason", 1}, 7}), REASONS[body(0, 1):uint()] or ""
end

bodies[13] = function(tree, body)
  return add_fields(tree, body, 0, POSE), ""
end

local MIN_BODY = {200, 33, 16, 56, 96, 40, 16, 16, 32, 32, 8, 0, 88}

local function dissect_body(kind, minor, body, tree, label)
  local dissect = bodies[kind]
  if dissect == nil then return "" end
  if body == nil or body:len() < MIN_BODY[kind] then
    tree:add_proto_expert_info(bad_length, label .. " is cut short")
    return ""
  end
  local branch = tree:add(body, label)
  local known, text = dissect(branch, body)
  if known == nil or known > body:len() then
    branch:add_proto_expert_info(bad_length, label .. " is cut short")
  elseif known < body:len() and minor > 0 then
    branch:add(f.surplus, body(known))
  elseif known < body:len() then
    branch:add_proto_expert_info(bad_length, label .. " is too long")
  end
  return text or ""
end

local function dissect_header(tree, buffer)
  add_fields(tree, buffer, 0, {{"magic", 4}, {"ver_major", 1}, {"ver_minor", 1}, {"type", 1}})
  local flags = tree:add(f.flags, buffer(7, 1))
  for _, name in ipairs({"mac", "refresh", "repeat", "clock_locked", "origin"}) do flags:add(f["flags." .. name], buffer(7, 1)) end
  add_fields(tree, buffer, 8, {{"header_len", 2}, {"total_len", 2}, {"stream_id", 4}, {"boot_id", 8}, {"seq", 8},
                               {"t_data_ns", 8}, {"age_us", 4}, {"map_rev", 4}})
  local health = tree:add_le(f.health, buffer(48, 2))
  for _, bit_of in ipairs(HEALTH) do health:add_le(f["health." .. bit_of[2]], buffer(48, 2)) end
  if buffer(49, 1):uint() >= 128 then health:add_proto_expert_info(fault) end
  add_fields(tree, buffer, 50, {{"cost_profile", 2}, {"config_hash", 4}, {"key_id", 2}})
end

function scree.dissector(buffer, packet, parent)
  local size = buffer:len()
  if size < 4 or buffer(0, 4):string() ~= "SCRE" then return 0 end
  packet.cols.protocol = "SCREE"
  local tree = parent:add(scree, buffer())
  if size < 64 then
    tree:add_proto_expert_info(bad_length, "the header is cut short")
    return size
  end
  dissect_header(tree, buffer)
  local kind, header_len, total = buffer(6, 1):uint(), buffer(8, 2):le_uint(), buffer(10, 2):le_uint()
  local name = TYPES[kind] or ("type " .. kind)
  packet.cols.info = string.format("%s %s seq %s", ORIGINS[math.floor(buffer(7, 1):uint() / 16) % 4], name,
                                   tostring(buffer(24, 8):le_uint64()))
  local mac = buffer(7, 1):uint() % 2 == 1 and 16 or 0
  local last = size - mac
  if total ~= size or header_len < 64 or header_len > last then
    tree:add_proto_expert_info(bad_length, "lengths disagree with the datagram")
    return size
  end
  local good = crc32(buffer, last) == buffer(60, 4):le_uint()
  local crc = tree:add_le(f.crc, buffer(60, 4))
  tree:add(f["crc.status"], buffer(60, 4), good and 1 or 0):set_generated()
  if not good then crc:add_proto_expert_info(bad_crc) end
  local body = last > header_len and buffer(header_len, last - header_len):tvb() or nil
  local text = dissect_body(kind, buffer(5, 1):uint(), body, tree, name)
  if mac > 0 then tree:add(f.mac, buffer(last, mac)) end
  if text ~= "" then packet.cols.info:append(" " .. text) end
  return size
end

scree:register_heuristic("udp", function(buffer, packet, parent)
  if buffer:len() < 4 or buffer(0, 4):string() ~= "SCRE" then return false end
  return scree.dissector(buffer, packet, parent) > 0
end)
