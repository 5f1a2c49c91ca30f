#pragma once

namespace httplib {
class TaskQueue;
}

namespace drupe {

/// New threads that serve connections, one each, for the library's server, which owns them. The library's own pool
/// queues without bound; here a connection that finds no free thread is handed back to the accepting thread at once
/// with IsRefusingConnection() true, so that it is told 503.
httplib::TaskQueue* NewConnectionThreads(int count);

/// True on the accepting thread while it turns a connection away.
bool IsRefusingConnection();

}  // namespace drupe
